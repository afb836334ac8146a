// SPDX-License-Identifier: Apache-2.0
#include "service/gstreamer/source.h"

#include <glib.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string_view>

namespace windhover {
namespace {

namespace fs = std::filesystem;

std::string Trimmed(std::string text) {
  const char* blanks = " \t\r";
  text.erase(0, std::min(text.find_first_not_of(blanks), text.size()));
  text.erase(text.find_last_not_of(blanks) + 1);
  return text;
}

// The "key=value" lines of the file, whatever their section.
std::map<std::string, std::string> ReadIni(const fs::path& path) {
  std::ifstream file(path);
  if (!file) throw SourceError(fmt::format("Cannot read {}", path.string()));
  std::map<std::string, std::string> values;
  for (std::string line; std::getline(file, line);) {
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos) continue;
    values[Trimmed(line.substr(0, equals))] = Trimmed(line.substr(equals + 1));
  }
  return values;
}

template <typename T>
std::optional<T> Number(const std::string& text) {
  T value{};
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return value;
}

// In printf patterns.
std::string PercentEscaped(const std::string& text) {
  std::string escaped;
  for (const char character : text) escaped += character == '%' ? "%%" : std::string(1, character);
  return escaped;
}

std::string MediaType(const std::string& extension) {
  if (extension == ".png") return "image/png";
  if (extension == ".jpg" || extension == ".jpeg") return "image/jpeg";
  throw SourceError(
      fmt::format("Sequence pictures of type '{}': .png and .jpg are known", extension));
}

Source FindSequence(const std::string& text) {
  const fs::path folder = fs::path(text);
  const fs::path ini = folder / "seqinfo.ini";
  if (!fs::exists(ini)) {
    throw SourceError(fmt::format("{} is a folder without seqinfo.ini: not a sequence", text));
  }
  auto values = ReadIni(ini);
  const auto or_default = [&](const char* key, const char* value) {
    const auto found = values.find(key);
    return found != values.end() && !found->second.empty() ? found->second : value;
  };
  Source source;
  source.name = text;
  source.stem = fs::absolute(folder).lexically_normal().filename().string();
  if (source.stem.empty()) {
    source.stem = fs::absolute(folder).lexically_normal().parent_path().filename().string();
  }
  const std::string extension = or_default("imExt", ".png");
  source.media_type = MediaType(extension);
  source.frame_rate_hz = Number<double>(values["frameRate"]).value_or(0.0);
  source.frames = Number<int>(values["seqLength"]).value_or(0);
  if (!(source.frame_rate_hz > 0.0 && source.frame_rate_hz <= 1000.0) || source.frames < 1) {
    throw SourceError(
        fmt::format("{}: frameRate and seqLength must be numbers above 0", ini.string()));
  }
  const fs::path pictures = folder / or_default("imDir", "img1");
  for (int number = 1; number <= source.frames; ++number) {
    const fs::path picture = pictures / fmt::format("{:06d}{}", number, extension);
    if (!fs::exists(picture)) {
      throw SourceError(fmt::format("{} is missing; seqinfo.ini says that there are {} pictures",
                                    picture.string(), source.frames));
    }
  }
  source.pattern = PercentEscaped(pictures.string()) + "/%06d" + extension;
  return source;
}

// By the size in the first RIFF chunk's header; 0 where there is no such header.
std::int64_t MissingBytesOfAvi(const fs::path& path) {
  std::array<unsigned char, 12> header{};
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(header.data()), header.size());
  const std::string_view bytes(reinterpret_cast<const char*>(header.data()), header.size());
  if (!file || bytes.substr(0, 4) != "RIFF" || bytes.substr(8) != "AVI ") return 0;
  const std::int64_t size =
      header[4] | header[5] << 8 | header[6] << 16 | static_cast<std::int64_t>(header[7]) << 24;
  // Writers that do not go back to fill it in leave this.
  if (size == 0xFFFFFFFF) return 0;
  return std::max<std::int64_t>(0, size + 8 - static_cast<std::int64_t>(fs::file_size(path)));
}

Source FindFile(const std::string& name, const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw SourceError(fmt::format("{}: no such file", name));
  if (fs::is_directory(status)) return FindSequence(path.string());
  if (!std::ifstream(path)) throw SourceError(fmt::format("{} cannot be read", name));
  if (fs::is_regular_file(status) && fs::file_size(path) == 0) {
    throw SourceError(fmt::format("{} is empty", name));
  }
  Source source;
  source.name = name;
  source.stem = path.stem().string();
  if (fs::is_regular_file(status)) source.missing_bytes = MissingBytesOfAvi(path);
  char* uri = g_filename_to_uri(fs::absolute(path).c_str(), nullptr, nullptr);
  if (uri == nullptr) throw SourceError(fmt::format("{} has no URI", name));
  source.uri = uri;
  g_free(uri);
  return source;
}

}  // namespace

Source FindSource(const std::string& text) {
  if (text.find("://") == std::string::npos) return FindFile(text, fs::path(text));
  if (char* path = g_filename_from_uri(text.c_str(), nullptr, nullptr)) {
    const fs::path file(path);
    g_free(path);
    return FindFile(text, file);
  }
  Source source;
  source.name = text;
  source.uri = text;
  source.stem = fs::path(text.substr(0, text.find_first_of("?#"))).stem().string();
  return source;
}

}  // namespace windhover
