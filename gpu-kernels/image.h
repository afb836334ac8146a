// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

namespace windhover {

// How the host is about to use mapped memory. kWrite loses what was there before.
enum class Access { kRead, kWrite };

// A block of bytes owned by a backend. Operators of the same backend use it where it lies; the host
// sees it only while it is mapped. On CPU backends and on PoCL mapping costs no copy.
class Memory {
 public:
  virtual ~Memory() = default;

  // The pointer is aligned to 64 bytes and valid until Unmap. Mappings for reading may nest; one
  // for writing stands alone. Throws DeviceError.
  virtual std::byte* Map(Access access) = 0;
  virtual void Unmap(std::byte* pointer) noexcept = 0;
};

// A mapped image: `stride` counts elements of T from one row to the next, stride >= width.
// Unmaps when it goes out of scope.
template <typename T>
class MappedImage {
 public:
  MappedImage(Memory& memory, Access access, int width, int height, std::ptrdiff_t stride)
      : memory_(&memory),
        bytes_(memory.Map(access)),
        width_(width),
        height_(height),
        stride_(stride) {}
  MappedImage(MappedImage&& other) noexcept { *this = std::move(other); }
  MappedImage& operator=(MappedImage&& other) noexcept {
    std::swap(memory_, other.memory_);
    std::swap(bytes_, other.bytes_);
    width_ = other.width_;
    height_ = other.height_;
    stride_ = other.stride_;
    return *this;
  }
  ~MappedImage() {
    if (bytes_ != nullptr) memory_->Unmap(bytes_);
  }

  T* data() const { return reinterpret_cast<T*>(bytes_); }
  T* row(int y) const { return data() + y * stride_; }
  T& at(int x, int y) const { return row(y)[x]; }
  int width() const { return width_; }
  int height() const { return height_; }
  std::ptrdiff_t stride() const { return stride_; }

 private:
  Memory* memory_ = nullptr;
  std::byte* bytes_ = nullptr;
  int width_ = 0;
  int height_ = 0;
  std::ptrdiff_t stride_ = 0;
};

// A single-channel picture that belongs to a backend; made by Backend::MakeImage. Pixel centres lie
// at integer coordinates, (0, 0) is the centre of the top left pixel, y points down. Rows are
// padded to 64 bytes; what lies in the padding is unspecified. Movable, not copyable.
//
// In registered images the grey value 0 means "no ground seen here"; see warp/warp.h.
template <typename T>
class Image {
 public:
  Image() = default;
  Image(std::unique_ptr<Memory> memory, int width, int height, std::ptrdiff_t stride)
      : memory_(std::move(memory)), width_(width), height_(height), stride_(stride) {}

  int width() const { return width_; }
  int height() const { return height_; }
  std::ptrdiff_t stride() const { return stride_; }
  bool empty() const { return memory_ == nullptr; }

  MappedImage<const T> Read() const { return {*memory_, Access::kRead, width_, height_, stride_}; }
  MappedImage<T> Write() { return {*memory_, Access::kWrite, width_, height_, stride_}; }

  // For the operators of the backend that made the image.
  Memory& memory() const { return *memory_; }

 private:
  std::unique_ptr<Memory> memory_;
  int width_ = 0;
  int height_ = 0;
  std::ptrdiff_t stride_ = 0;
};

using GrayImage = Image<std::uint8_t>;

// One bit a pixel: pixel (x, y) is bit x % 32 of word (x / 32, y), least significant bit first.
// Bits past the width are 0. `words` is an image of ceil(width / 32) x height words.
struct BitImage {
  Image<std::uint32_t> words;
  int width = 0;
  int height = 0;
};

}  // namespace windhover
