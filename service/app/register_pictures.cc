// SPDX-License-Identifier: Apache-2.0
#include "service/app/register_pictures.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>

#include "gpu-kernels/backend.h"
#include "service/app/exit_code.h"
#include "service/app/pair_pictures.h"
#include "service/app/pair_text.h"
#include "service/app/pending_file.h"
#include "service/app/picture_file.h"
#include "service/dds/log.h"
#include "service/vision/registration.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

GrayImage Upload(Backend& backend, const cv::Mat& picture) {
  GrayImage image = backend.MakeImage<std::uint8_t>(picture.cols, picture.rows);
  const auto mapped = image.Write();
  for (int y = 0; y < picture.rows; ++y) {
    std::copy_n(picture.ptr<std::uint8_t>(y), picture.cols, mapped.row(y));
  }
  return image;
}

FrameRegistration Register(const RegisterOptions& options, const cv::Mat& a, const cv::Mat& b) {
  const auto backend =
      Backend::Create(options.device, [](const std::string& text) { Log()->warn("{}", text); });
  StreamRegistration stream(backend, a.cols, a.rows, options.registration);
  stream.Register(Upload(*backend, b));
  return stream.Register(Upload(*backend, a));
}

// Names only what is whole: every file is written before the first one takes its name.
void WriteResults(const fs::path& out, const PicturePair& pair, const cv::Mat& a,
                  const cv::Mat& b) {
  fs::create_directories(out);
  PendingFile result(out / "result.json");
  PendingFile blended(out / "blended.png");
  PendingFile difference(out / "difference.png");
  std::ofstream lines(result.temporary(), std::ios::binary);
  lines << JsonOf(pair);
  lines.close();
  if (!lines) throw std::runtime_error(out.string() + ": cannot be written to");
  if (pair.registration.quality == RegistrationQuality::kLost) {
    // Those of an earlier result would contradict this one.
    fs::remove(out / "blended.png");
    fs::remove(out / "difference.png");
  } else {
    const PairPictures pictures = CompareAligned(a, b, pair.registration.previous_from_frame);
    WritePng(blended.temporary(), pictures.blended);
    WritePng(difference.temporary(), pictures.difference);
    blended.Complete();
    difference.Complete();
  }
  result.Complete();
}

}  // namespace

int RegisterPictures(const RegisterOptions& options) {
  const cv::Mat a = ReadGrayPicture(options.a);
  const cv::Mat b = ReadGrayPicture(options.b);
  if (a.size() != b.size()) {
    throw std::runtime_error(
        fmt::format("{} has {}x{} px, but {} has {}x{} px: both must have one "
                    "size",
                    options.a, a.cols, a.rows, options.b, b.cols, b.rows));
  }
  const PicturePair pair = {options.a, options.b, a.cols, a.rows, Register(options, a, b)};
  if (!options.out.empty()) WriteResults(options.out, pair, a, b);
  fmt::print("{}", options.json ? JsonOf(pair) : TextOf(pair));
  std::fflush(stdout);
  return pair.registration.quality == RegistrationQuality::kValid ? kExitOk : kExitNotValid;
}

}  // namespace windhover
