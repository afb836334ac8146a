// SPDX-License-Identifier: Apache-2.0
#include "replay/render/flight_plan.h"

#include <stdexcept>

namespace windhover::replay {

const std::vector<FlightPlan>& FlightPlans() {
  static const std::vector<FlightPlan> plans = {[] {
    FlightPlan plan;
    plan.number = "01";
    plan.name = "outskirts";
    return plan;
  }()};
  return plans;
}

FlightPlan FindFlightPlan(const std::string& name) {
  if (name == "flight") return FlightPlans().front();
  std::string known;
  for (const FlightPlan& plan : FlightPlans()) {
    if (name == plan.name || name == plan.number || "0" + name == plan.number) return plan;
    known += " " + plan.number + " (" + plan.name + ")";
  }
  throw std::invalid_argument("no sequence '" + name + "'; there is: flight," + known);
}

}  // namespace windhover::replay
