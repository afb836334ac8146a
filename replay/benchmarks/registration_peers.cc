// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/registration_peers.h"

#include "replay/baselines/dual_registration.h"
#include "replay/baselines/ecc_registration.h"
#include "replay/baselines/gold_standard_registration.h"
#include "replay/baselines/klt_registration.h"
#include "replay/baselines/phase_correlate_registration.h"

namespace windhover::replay {
namespace {

using Peer = std::unique_ptr<RegistrationPeer>;

template <EccRegistration::Start start>
Peer MakeEcc() {
  return std::make_unique<EccRegistration>(start);
}

template <FeatureDetector detector, RobustEstimator robust = RobustEstimator::kRansac>
Peer MakeGoldStandard() {
  FeatureRegistrationOptions options;
  options.detector = detector;
  options.robust = robust;
  return std::make_unique<GoldStandardRegistration>(options);
}

}  // namespace

const std::vector<RegistrationPeerKind>& RegistrationPeerKinds() {
  static const std::vector<RegistrationPeerKind> kinds = {
      {"klt", "KLT grid + RANSAC", false,
       []() -> Peer { return std::make_unique<KltRegistration>(); }},
      {"sift", "gold standard, SIFT", true, MakeGoldStandard<FeatureDetector::kSift>},
      {"sift_lmeds", "gold standard, SIFT, LMedS", true,
       MakeGoldStandard<FeatureDetector::kSift, RobustEstimator::kLmeds>},
      {"akaze", "gold standard, AKAZE", true, MakeGoldStandard<FeatureDetector::kAkaze>},
      {"orb", "gold standard, ORB", true, MakeGoldStandard<FeatureDetector::kOrb>},
      {"ecc", "ECC from phase correlation", true,
       MakeEcc<EccRegistration::Start::kPhaseCorrelation>},
      {"ecc_identity", "ECC from identity", true, MakeEcc<EccRegistration::Start::kIdentity>},
      {"dual", "dual inverse compositional from phase correlation", true,
       []() -> Peer { return std::make_unique<DualRegistrationPeer>(); }},
      {"phase_correlate", "cv::phaseCorrelate", true,
       []() -> Peer { return std::make_unique<PhaseCorrelateRegistration>(); }},
  };
  return kinds;
}

}  // namespace windhover::replay
