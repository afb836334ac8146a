// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cstring>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gpu-kernels/backend.h"
#include "replay/baselines/dual_registration.h"
#include "replay/baselines/ecc_registration.h"
#include "replay/baselines/frame_differencing.h"
#include "replay/baselines/gold_standard_registration.h"
#include "replay/baselines/klt_registration.h"
#include "replay/baselines/phase_correlate_registration.h"
#include "replay/baselines/stabilized_mog2.h"
#include "replay/scoring/motion_score.h"
#include "tests/support/synthetic_ground.h"

namespace windhover::replay {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;

// A vehicle, in pixels of the frame, with stripes across it as of windows and shadows.
struct Car {
  cv::Rect at;
  double bright;
  double dark;
};

cv::Mat Picture(const Eigen::Matrix3d& ground_from_frame, double noise_sigma, std::uint32_t seed,
                const std::vector<Car>& cars = {}) {
  static const SyntheticGround ground(3);
  static const std::shared_ptr<Backend> backend = Backend::Create("cpu");
  GrayImage image = backend->MakeImage<std::uint8_t>(kWidth, kHeight);
  ground.Render(ground_from_frame, noise_sigma, seed, image, [&cars](int x, int y, double value) {
    for (const Car& car : cars) {
      if (car.at.contains({x, y})) return (x - car.at.x) / 3 % 2 == 0 ? car.bright : car.dark;
    }
    return value;
  });
  cv::Mat picture(kHeight, kWidth, CV_8UC1);
  const MappedImage<const std::uint8_t> pixels = image.Read();
  for (int y = 0; y < kHeight; ++y) std::memcpy(picture.ptr(y), pixels.row(y), kWidth);
  return picture;
}

template <FeatureDetector detector>
std::unique_ptr<RegistrationPeer> MakeGoldStandard() {
  FeatureRegistrationOptions options;
  options.detector = detector;
  return std::make_unique<GoldStandardRegistration>(options);
}

struct NamedPeer {
  std::string name;
  std::unique_ptr<RegistrationPeer> (*make)();
  double rms_px;  // that it must reach with a small motion
};

// As it prints in the names of the tests.
void PrintTo(const NamedPeer& peer, std::ostream* out) { *out << peer.name; }

const NamedPeer kPeers[] = {
    {"klt",
     []() -> std::unique_ptr<RegistrationPeer> { return std::make_unique<KltRegistration>(); },
     0.1},
    {"sift", MakeGoldStandard<FeatureDetector::kSift>, 0.1},
    {"akaze", MakeGoldStandard<FeatureDetector::kAkaze>, 0.2},
    {"orb", MakeGoldStandard<FeatureDetector::kOrb>, 0.5},
    {"ecc",
     []() -> std::unique_ptr<RegistrationPeer> {
       return std::make_unique<EccRegistration>(EccRegistration::Start::kPhaseCorrelation);
     },
     0.05},
    {"ecc_identity",
     []() -> std::unique_ptr<RegistrationPeer> {
       return std::make_unique<EccRegistration>(EccRegistration::Start::kIdentity);
     },
     0.05},
    {"dual",
     []() -> std::unique_ptr<RegistrationPeer> { return std::make_unique<DualRegistrationPeer>(); },
     0.05},
};

class RegistrationPeers : public testing::TestWithParam<NamedPeer> {};
INSTANTIATE_TEST_SUITE_P(All, RegistrationPeers, testing::ValuesIn(kPeers),
                         [](const auto& info) { return info.param.name; });

TEST_P(RegistrationPeers, FindAKnownHomography) {
  const auto peer = GetParam().make();
  const Eigen::Matrix3d first = CameraMotion(kWidth, kHeight, 0.0, 1.0, 0, 0);
  const Eigen::Matrix3d second = CameraMotion(kWidth, kHeight, 0.01, 1.01, 3.4, -2.3, 1e-5);
  const Eigen::Matrix3d third = CameraMotion(kWidth, kHeight, 0.02, 1.0, 6.1, -5.0);
  EXPECT_FALSE(peer->Register(Picture(first, 2, 1)));
  const std::optional<Eigen::Matrix3d> found = peer->Register(Picture(second, 2, 2));
  ASSERT_TRUE(found);
  EXPECT_DOUBLE_EQ((*found)(2, 2), 1);
  EXPECT_LT(HomographyRms(*found, first.inverse() * second, kWidth, kHeight), GetParam().rms_px);
  const std::optional<Eigen::Matrix3d> next = peer->Register(Picture(third, 2, 3));
  ASSERT_TRUE(next);
  EXPECT_LT(HomographyRms(*next, second.inverse() * third, kWidth, kHeight), GetParam().rms_px);
}

TEST_P(RegistrationPeers, ForgetThePictureBeforeAReset) {
  const auto peer = GetParam().make();
  const Eigen::Matrix3d first = CameraMotion(kWidth, kHeight, 0.0, 1.0, 200, 90);
  const Eigen::Matrix3d second = CameraMotion(kWidth, kHeight, 0.0, 1.0, 202, 91);
  EXPECT_FALSE(peer->Register(Picture(Eigen::Matrix3d::Identity(), 2, 1)));
  peer->Reset();
  EXPECT_FALSE(peer->Register(Picture(first, 2, 2)));
  const std::optional<Eigen::Matrix3d> found = peer->Register(Picture(second, 2, 3));
  ASSERT_TRUE(found);
  EXPECT_LT(HomographyRms(*found, first.inverse() * second, kWidth, kHeight), GetParam().rms_px);
}

TEST_P(RegistrationPeers, FindTheSameWhateverCameBefore) {
  const Eigen::Matrix3d first = CameraMotion(kWidth, kHeight, 0.0, 1.0, 0, 0);
  const Eigen::Matrix3d second = CameraMotion(kWidth, kHeight, 0.01, 1.01, 3.4, -2.3);
  const cv::Mat pictures[] = {Picture(first, 2, 1), Picture(second, 2, 2)};
  const auto used = GetParam().make();
  for (int i = 0; i < 5; ++i) {
    used->Register(Picture(CameraMotion(kWidth, kHeight, 0.0, 1.0, 5 * i, 0), 2, 10 + i));
  }
  used->Reset();
  const auto fresh = GetParam().make();
  for (RegistrationPeer* peer : {used.get(), fresh.get()}) peer->Register(pictures[0]);
  const std::optional<Eigen::Matrix3d> of_used = used->Register(pictures[1]);
  const std::optional<Eigen::Matrix3d> of_fresh = fresh->Register(pictures[1]);
  ASSERT_TRUE(of_used && of_fresh);
  // Not to the bit: OpenCV's threads may find points in another order.
  EXPECT_LT(HomographyRms(*of_used, *of_fresh, kWidth, kHeight), 0.05);
}

TEST_P(RegistrationPeers, SurvivePicturesWithoutTexture) {
  const auto peer = GetParam().make();
  const cv::Mat gray(kHeight, kWidth, CV_8UC1, cv::Scalar(90));
  for (int i = 0; i < 2; ++i) {
    const std::optional<Eigen::Matrix3d> found = peer->Register(gray);
    EXPECT_TRUE(!found || found->allFinite());
  }
}

TEST(PhaseCorrelatePeer, FindsAShift) {
  PhaseCorrelateRegistration peer;
  const Eigen::Matrix3d first = CameraMotion(kWidth, kHeight, 0.0, 1.0, 0, 0);
  const Eigen::Matrix3d second = CameraMotion(kWidth, kHeight, 0.0, 1.0, 17.4, -9.3);
  EXPECT_FALSE(peer.Register(Picture(first, 2, 1)));
  const std::optional<Eigen::Matrix3d> found = peer.Register(Picture(second, 2, 2));
  ASSERT_TRUE(found);
  EXPECT_LT(HomographyRms(*found, second, kWidth, kHeight), 0.3);
  peer.Reset();
  EXPECT_FALSE(peer.Register(Picture(second, 2, 3)));
}

// What an identity start is worth where things move far.
TEST(EccPeer, ReachesFurtherFromPhaseCorrelation) {
  const Eigen::Matrix3d far = CameraMotion(kWidth, kHeight, 0.005, 1.0, 70, 30);
  const auto rms = [&](EccRegistration::Start start) {
    EccRegistration peer(start);
    peer.Register(Picture(Eigen::Matrix3d::Identity(), 2, 1));
    const std::optional<Eigen::Matrix3d> found = peer.Register(Picture(far, 2, 2));
    return HomographyRms(found.value_or(Eigen::Matrix3d::Identity()), far, kWidth, kHeight);
  };
  EXPECT_LT(rms(EccRegistration::Start::kPhaseCorrelation), 0.05);
  EXPECT_GT(rms(EccRegistration::Start::kIdentity), 2);
}

// As far as phase correlation does, and through another exposure.
TEST(DualRegistrationPeer, ReachesFarUnderAnotherExposure) {
  const Eigen::Matrix3d far = CameraMotion(kWidth, kHeight, 0.005, 1.0, 70, 30);
  DualRegistrationPeer peer;
  peer.Register(Picture(Eigen::Matrix3d::Identity(), 2, 1));
  cv::Mat dark;
  Picture(far, 2, 2).convertTo(dark, -1, 0.7, 12);
  const std::optional<Eigen::Matrix3d> found = peer.Register(dark);
  ASSERT_TRUE(found);
  EXPECT_LT(HomographyRms(*found, far, kWidth, kHeight), 0.05);
}

MotionOptions Extraction(int erosion, int dilation, int min_area) {
  MotionOptions options;
  options.erosion_px = erosion;
  options.dilation_px = dilation;
  options.min_area_px = min_area;
  return options;
}

TEST(ObjectExtraction, BoxesTheGivenPixels) {
  cv::Mat map = cv::Mat::zeros(100, 120, CV_8UC1);
  map(cv::Rect(10, 20, 6, 4)) = 255;
  map(cv::Rect(17, 20, 2, 4)) = 255;   // one pixel away: the same object once both have grown
  map(cv::Rect(60, 60, 3, 3)) = 255;   // too small
  map(cv::Rect(0, 90, 100, 2)) = 255;  // too long
  const std::vector<MovingObject> objects = ExtractObjects(map, Extraction(0, 1, 12));
  ASSERT_EQ(objects.size(), 1);
  EXPECT_EQ(objects[0].area_px, 32);
  EXPECT_EQ(objects[0].box.x, 10);
  EXPECT_EQ(objects[0].box.y, 20);
  EXPECT_EQ(objects[0].box.width, 9);
  EXPECT_EQ(objects[0].box.height, 4);
  EXPECT_EQ(ExtractObjects(map, Extraction(0, 0, 8)).size(), 3);
  EXPECT_TRUE(ExtractObjects(map, Extraction(2, 1, 1)).empty());
}

TEST(DifferenceMap, IsBlindBesideTheFrameBefore) {
  const cv::Mat previous(40, 60, CV_8UC1, cv::Scalar(100));
  const cv::Mat gray(40, 60, CV_8UC1, cv::Scalar(120));
  Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
  shift(0, 2) = 10.5;
  const cv::Mat map = DifferenceMap(gray, previous, shift, 20);
  EXPECT_EQ(cv::countNonZero(map), 49 * 40);  // columns 0 to 48 lie wholly on the frame before
  EXPECT_EQ(map.at<std::uint8_t>(0, 48), 255);
  EXPECT_EQ(cv::countNonZero(DifferenceMap(gray, previous, shift, 21)), 0);
}

Box BoxOf(const cv::Rect& rectangle) {
  return {static_cast<double>(rectangle.x), static_cast<double>(rectangle.y),
          static_cast<double>(rectangle.width), static_cast<double>(rectangle.height)};
}

// A camera that moves by 4 px a frame over the ground with two cars: one parked, one that drives at
// `speed_px` a frame. Shows `frames` frames to the peer and scores what it says from `first` on.
MotionScore ScoreOnSyntheticScene(MotionPeer& peer, int frames, int first, int speed_px) {
  std::vector<LabelledBox> truth;
  std::vector<LabelledBox> found;
  Eigen::Matrix3d ground_from_previous = Eigen::Matrix3d::Identity();
  for (int i = 0; i < frames; ++i) {
    const Eigen::Matrix3d ground_from_frame =
        CameraMotion(kWidth, kHeight, 0, 1, 4.0 * i, 2.0 * (i % 2));
    FrameRegistration registration;
    registration.starts_segment = i == 0;
    registration.previous_from_frame = ground_from_previous.inverse() * ground_from_frame;
    ground_from_previous = ground_from_frame;
    const cv::Rect driving(150 + (speed_px - 4) * i, 80 - 2 * (i % 2), 16, 8);
    const cv::Rect parked(200 - 4 * i, 160 - 2 * (i % 2), 16, 8);
    const cv::Mat picture =
        Picture(ground_from_frame, 2, i + 1, {{driving, 250, 190}, {parked, 5, 60}});
    const std::vector<MovingObject> objects = peer.Detect(picture, registration);
    if (i < first) continue;
    for (const MovingObject& object : objects) found.push_back({i, -1, object.box});
    truth.push_back({i, 1, BoxOf(driving)});
  }
  return ScoreMotion(truth, found);
}

TEST(FrameDifferencingPeer, FindsWhatDrivesAndNotWhatIsParked) {
  FrameDifferencing peer({}, {});
  const MotionScore score = ScoreOnSyntheticScene(peer, 20, 1, 7);
  EXPECT_EQ(score.truth, 19);
  EXPECT_GT(*score.recall(), 0.9);
  EXPECT_GT(*score.precision(), 0.9);
}

TEST(FrameDifferencingPeer, MissesWhatHardlyMoves) {
  FrameDifferencing peer({}, {});
  EXPECT_EQ(ScoreOnSyntheticScene(peer, 10, 1, 0).hits, 0);
}

TEST(FrameDifferencingPeer, SeesNothingAtTheStartOfASegment) {
  FrameDifferencing peer({}, {});
  FrameRegistration registration;
  registration.starts_segment = true;
  const cv::Mat dark(kHeight, kWidth, CV_8UC1, cv::Scalar(20));
  cv::Mat spot = dark.clone();
  spot(cv::Rect(50, 50, 10, 10)) = 200;
  EXPECT_THAT(peer.Detect(dark, registration), testing::IsEmpty());
  EXPECT_THAT(peer.Detect(spot, registration), testing::IsEmpty());
  registration.starts_segment = false;
  EXPECT_THAT(peer.Detect(dark, registration), testing::SizeIs(1));
}

TEST(StabilizedMog2Peer, FindsWhatDrivesAndNotWhatIsParked) {
  StabilizedMog2 peer({});
  // 240 px in all: the camera leaves the first canvas on the way.
  const MotionScore score = ScoreOnSyntheticScene(peer, 60, 15, 3);
  EXPECT_EQ(score.truth, 45);
  EXPECT_GT(*score.recall(), 0.9);
  EXPECT_GT(*score.precision(), 0.9);
}

}  // namespace
}  // namespace windhover::replay
