// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "gpu-kernels/backend.h"
#include "gpu-kernels/phase_correlation/phase_correlation.h"
#include "service/options/options.h"
#include "service/vision/homography_estimator.h"
#include "service/vision/types.h"

namespace windhover {

// A frame laid over a reference picture of the same size.
struct TileMeasurement {
  Eigen::Matrix3d reference_from_frame = Eigen::Matrix3d::Identity();  // h33 = 1
  Matrix8d corner_covariance = Matrix8d::Zero();                       // see HomographyEstimate
  int inliers = 0;
  int tiles = 0;
  double residual_px = 0.0;
  double overlap = 0.0;
  RegistrationQuality quality = RegistrationQuality::kLost;
};

// A kept picture that frames are laid over.
struct TileReference {
  std::unique_ptr<TileSpectra> spectra;
  std::unique_ptr<TileSpectra> fine_spectra;  // null where there are no fine tiles
};

// Tiled phase correlation between a kept reference picture and frames (thesis 2.4.2, 2.4.3). The
// frame is sampled under a predicted homography, so that tiles match however far and turned it is;
// where the prediction was off by so much that the tiles saw different ground, they are matched
// once more under the first result. Keeps its working memory; one thread at a time.
class TileRegistration {
 public:
  // Throws OptionError where the pictures are too small for the tiles.
  TileRegistration(Backend& backend, int width, int height, const RegistrationOptions& options);

  // Memory for one reference picture.
  TileReference MakeReference() const;
  void SetReference(const GrayImage& picture, TileReference& reference);

  // Whether the reference has enough texture to be matched at all.
  bool HasTexture(const TileReference& reference);

  // quality is kLost, and all else at its default, where no homography was found.
  TileMeasurement Measure(const TileReference& reference, const GrayImage& frame,
                          const Eigen::Matrix3d& predicted_frame_from_reference);

  // The same with finer tiles as well, about 5/3 times as many each way, which tell the ground from
  // what stands out of it and see more where there is little to see. Worth its price, twice that of
  // Measure, where the covariance is large. Inliers, tiles and quality stay those of the layout
  // that was asked for.
  TileMeasurement Refine(const TileMeasurement& measurement, const TileReference& reference,
                         const GrayImage& frame);

 private:
  // A layout with its working memory.
  struct Layout {
    explicit Layout(std::unique_ptr<PhaseCorrelation> correlation_in);
    std::unique_ptr<PhaseCorrelation> correlation;
    std::unique_ptr<TileSpectra> current;
    std::vector<TilePeak> peaks;
  };

  // Appends to matches_.
  void Match(Layout& layout, const TileSpectra& reference, const GrayImage& frame,
             const Eigen::Matrix3d& predicted_frame_from_reference);
  TileMeasurement MeasureOnce(const TileReference& reference, const GrayImage& frame,
                              const Eigen::Matrix3d& predicted_frame_from_reference);
  void SetEstimate(const HomographyEstimate& estimate, TileMeasurement& measurement) const;
  bool NeedsSecondPass(const Eigen::Matrix3d& predicted_frame_from_reference,
                       const Eigen::Matrix3d& reference_from_frame) const;
  RegistrationQuality Judge(const TileMeasurement& measurement, int peaks) const;

  int width_;
  int height_;
  RegistrationOptions options_;
  Layout coarse_;
  std::optional<Layout> fine_;
  HomographyEstimator estimator_;
  std::vector<PointMatch> matches_;
};

}  // namespace windhover
