// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/registration_peers.h"

#include "replay/baselines/dual_registration.h"
#include "replay/baselines/ecc_registration.h"
#include "replay/baselines/feature_registration.h"
#include "replay/baselines/klt_registration.h"
#include "replay/baselines/phase_correlate_registration.h"

namespace windhover::replay {
namespace {

using Peer = std::unique_ptr<RegistrationPeer>;

template <EccRegistration::Start start>
Peer MakeEcc() {
  return std::make_unique<EccRegistration>(start);
}

}  // namespace

const std::vector<RegistrationPeerKind>& RegistrationPeerKinds() {
  static const std::vector<RegistrationPeerKind> kinds = {
      {"klt", "KLT grid + RANSAC", false,
       []() -> Peer { return std::make_unique<KltRegistration>(); }},
      {"orb", "ORB + RANSAC", true, []() -> Peer { return MakeOrbRegistration(); }},
      {"sift", "SIFT + RANSAC", true, []() -> Peer { return MakeSiftRegistration(); }},
      {"akaze", "AKAZE + RANSAC", true, []() -> Peer { return MakeAkazeRegistration(); }},
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
