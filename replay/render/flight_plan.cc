// SPDX-License-Identifier: Apache-2.0
#include "replay/render/flight_plan.h"

#include <algorithm>
#include <stdexcept>

namespace windhover::replay {
namespace {

// Numbers below this are of the ten that "all" stands for.
constexpr const char* kAfterTheTen = "11";

}  // namespace

FlightPlan FindFlightPlan(const std::string& name) {
  if (name == "flight") return FlightPlans().front();
  std::string known;
  for (const FlightPlan& plan : FlightPlans()) {
    if (name == plan.name || name == plan.number || "0" + name == plan.number) return plan;
    known += " " + plan.number + " (" + plan.name + ")";
  }
  throw std::invalid_argument("no sequence '" + name + "'; there is: flight," + known);
}

std::vector<FlightPlan> FindFlightPlans(const std::string& names) {
  std::vector<FlightPlan> found;
  const auto add = [&found](const FlightPlan& plan) {
    for (const FlightPlan& other : found) {
      if (other.number == plan.number) {
        throw std::invalid_argument("sequence " + plan.number + " is named twice");
      }
    }
    found.push_back(plan);
  };
  for (std::size_t start = 0; start <= names.size();) {
    const std::size_t end = std::min(names.find(',', start), names.size());
    const std::string name = names.substr(start, end - start);
    start = end + 1;
    if (name != "all") {
      add(FindFlightPlan(name));
      continue;
    }
    for (const FlightPlan& plan : FlightPlans()) {
      if (plan.number < kAfterTheTen) add(plan);
    }
  }
  return found;
}

}  // namespace windhover::replay
