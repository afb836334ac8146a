// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "replay/scoring/motion_score.h"

namespace windhover::replay {

struct TrackScore {
  int objects = 0;         // identities in truth that count in some frame
  int id_switches = 0;     // an object's detection has another track id than the one before had
  int fragmentations = 0;  // an object that was found is missed, and then found again
};

// Identities over time as in CLEAR MOT (Bernardin and Stiefelhagen, "Evaluating Multiple Object
// Tracking Performance", EURASIP JIVP 2008): an object keeps the detection with the track id that
// it had when it was last found, as long as the rule allows; all others are paired as in
// MatchFrame. Fragmentations as in MOTChallenge. Frames in which an object is not labelled or does
// not count say nothing about it. Nothing where truth that counts or a detection has no identity.
std::optional<TrackScore> ScoreTracks(std::span<const FrameBoxes> frames, const HitRule& rule);

}  // namespace windhover::replay
