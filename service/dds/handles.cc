// SPDX-License-Identifier: Apache-2.0
#include "service/dds/handles.h"

namespace windhover {

Qos MakeQos(bool reliable, int max_blocking_ms, int history_depth, const std::string& partition) {
  Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       DDS_MSECS(max_blocking_ms));
  if (history_depth == 0) {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, DDS_LENGTH_UNLIMITED);
  } else {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, history_depth);
  }
  dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
  dds_qset_resource_limits(qos.get(), DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                           DDS_LENGTH_UNLIMITED);
  if (!partition.empty()) dds_qset_partition1(qos.get(), partition.c_str());
  return qos;
}

}  // namespace windhover
