// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "service/dds/samples.h"
#include "service/dds/subscriber.h"

namespace windhover {

// One line each, with its line feed. The JSON lines are described in README.md; a number that is
// not finite becomes null.
std::string JsonLine(const HomographySample& sample);
std::string JsonLine(const DetectionsSample& sample);
std::string JsonEndLine(const std::string& stream, Topic topic, Subscriber::EndReason reason);
std::string JsonPublishersLine(int publishers);

// The same for people.
std::string TextLine(const HomographySample& sample);
std::string TextLine(const DetectionsSample& sample);
std::string TextEndLine(const std::string& stream, Topic topic, Subscriber::EndReason reason);
std::string TextPublishersLine(int publishers);

}  // namespace windhover
