// SPDX-License-Identifier: Apache-2.0
#include "service/app/pair_text.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "service/app/registration_json.h"
#include "service/vision/homography.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

double InlierShare(const FrameRegistration& registration) {
  return registration.tiles > 0 ? static_cast<double>(registration.inliers) / registration.tiles
                                : 0.0;
}

}  // namespace

std::string TextOf(const PicturePair& pair) {
  const FrameRegistration& registration = pair.registration;
  std::string text = fmt::format("registration of {} to {} ({}x{} px): {}\n", pair.a, pair.b,
                                 pair.width, pair.height, NameOf(registration.quality));
  text += fmt::format("{} of {} tiles agree ({:.0f} %)", registration.inliers, registration.tiles,
                      100.0 * InlierShare(registration));
  if (registration.quality == RegistrationQuality::kLost) return text + "\n";

  text += fmt::format(", residual {:.3f} px RMS, overlap {:.0f} %\n", registration.residual_px,
                      100.0 * registration.overlap);
  const Eigen::Matrix3d& b_from_a = registration.previous_from_frame;
  text += "b_from_a takes points (x, y) of A to B, px, pixel centres at 0-based integers:\n";
  for (int row = 0; row < 3; ++row) {
    text += fmt::format("  {:16.9e} {:16.9e} {:16.9e}\n", b_from_a(row, 0), b_from_a(row, 1),
                        b_from_a(row, 2));
  }
  text += "corners of A in B, with the standard deviations of that measurement, px:\n";
  constexpr std::array kCornerNames = {"top left", "top right", "bottom right", "bottom left"};
  const auto corners = PictureCorners(pair.width, pair.height);
  for (int corner = 0; corner < 4; ++corner) {
    const Eigen::Vector2d x_in_b = Project(b_from_a, corners[corner]);
    const auto deviation = [&](int i) {
      return std::sqrt(registration.corner_covariance(2 * corner + i, 2 * corner + i));
    };
    text += fmt::format("  {:12} x {:10.3f} +- {:.3f}   y {:10.3f} +- {:.3f}\n",
                        kCornerNames[corner], x_in_b.x(), deviation(0), x_in_b.y(), deviation(1));
  }
  return text;
}

std::string JsonOf(const PicturePair& pair) {
  const FrameRegistration& registration = pair.registration;
  const bool found = registration.quality != RegistrationQuality::kLost;
  Json json;
  json["type"] = "registration";
  json["a"] = pair.a;
  json["b"] = pair.b;
  json["width"] = pair.width;
  json["height"] = pair.height;
  json["quality"] = NameOf(registration.quality);
  json["b_from_a"] = found ? RowMajor<3>(registration.previous_from_frame) : Json();
  json["corner_covariance_px2"] = found ? RowMajor<8>(registration.corner_covariance) : Json();
  json["inliers"] = registration.inliers;
  json["tiles"] = registration.tiles;
  json["inlier_share"] = InlierShare(registration);
  json["residual_px"] = found ? Json(registration.residual_px) : Json();
  json["overlap"] = found ? Json(registration.overlap) : Json();
  // File names may hold bytes that are not UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace windhover
