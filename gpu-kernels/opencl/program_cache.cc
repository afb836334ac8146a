// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/opencl/program_cache.h"

#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>

namespace windhover::opencl {
namespace {

// The first bytes of a file; the number changes with the layout: magic, key size, binary size,
// checksum of key and binary, key, binary.
constexpr char kMagic[8] = {'W', 'H', 'P', 'R', 'O', 'G', '0', '1'};

struct Header {
  char magic[8];
  std::uint64_t key_size;
  std::uint64_t binary_size;
  std::uint64_t checksum;
};

constexpr std::uint64_t kFnvOffset = 0xcbf29ce484222325U;

// FNV-1a.
std::uint64_t Hash(const void* data, std::size_t size, std::uint64_t hash) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 0x100000001b3U;
  return hash;
}

std::uint64_t Checksum(const std::string& key, const unsigned char* binary, std::size_t size) {
  return Hash(binary, size, Hash(key.data(), key.size(), kFnvOffset));
}

}  // namespace

std::filesystem::path ProgramCache::DefaultFolder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && cache[0] == '/') {
    return std::filesystem::path(cache) / "windhover";
  }
  if (const char* home = std::getenv("HOME"); home != nullptr && home[0] == '/') {
    return std::filesystem::path(home) / ".cache" / "windhover";
  }
  return {};
}

std::filesystem::path ProgramCache::FileOf(const std::string& key) const {
  char name[48];
  std::snprintf(name, sizeof(name), "%016llx.clbin",
                static_cast<unsigned long long>(Hash(key.data(), key.size(), kFnvOffset)));
  return folder_ / name;
}

std::optional<std::vector<unsigned char>> ProgramCache::Load(const std::string& key) const {
  if (folder_.empty()) return std::nullopt;
  std::ifstream file(FileOf(key), std::ios::binary);
  const std::vector<char> content{std::istreambuf_iterator<char>(file), {}};
  Header header;
  if (content.size() < sizeof(header) + key.size()) return std::nullopt;
  std::memcpy(&header, content.data(), sizeof(header));
  if (std::memcmp(header.magic, kMagic, sizeof(kMagic)) != 0 || header.key_size != key.size() ||
      header.binary_size != content.size() - sizeof(header) - key.size() ||
      std::memcmp(content.data() + sizeof(header), key.data(), key.size()) != 0) {
    return std::nullopt;
  }
  const auto* binary =
      reinterpret_cast<const unsigned char*>(content.data() + sizeof(header) + key.size());
  if (header.checksum != Checksum(key, binary, header.binary_size)) return std::nullopt;
  return std::vector<unsigned char>(binary, binary + header.binary_size);
}

void ProgramCache::Store(const std::string& key, const std::vector<unsigned char>& binary) const {
  if (folder_.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) return;

  static std::atomic<unsigned> counter{0};
  const std::filesystem::path path = FileOf(key);
  std::filesystem::path temporary = path;
  temporary += '.' + std::to_string(getpid()) + '.' + std::to_string(counter++);

  Header header;
  std::memcpy(header.magic, kMagic, sizeof(kMagic));
  header.key_size = key.size();
  header.binary_size = binary.size();
  header.checksum = Checksum(key, binary.data(), binary.size());
  std::ofstream file(temporary, std::ios::binary);
  file.write(reinterpret_cast<const char*>(&header), sizeof(header));
  file.write(key.data(), static_cast<std::streamsize>(key.size()));
  file.write(reinterpret_cast<const char*>(binary.data()),
             static_cast<std::streamsize>(binary.size()));
  file.close();
  if (file) {
    std::filesystem::rename(temporary, path, error);
    if (!error) return;
  }
  std::filesystem::remove(temporary, error);
}

}  // namespace windhover::opencl
