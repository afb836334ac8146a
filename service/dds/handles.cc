// SPDX-License-Identifier: Apache-2.0
#include "service/dds/handles.h"

#include <cstdint>
#include <vector>

namespace windhover {
namespace {

void SetPartitions(dds_qos_t* qos, std::string partitions) {
  std::vector<const char*> names = {partitions.data()};
  for (char& character : partitions) {
    if (character != ',') continue;
    character = '\0';
    names.push_back(&character + 1);
  }
  dds_qset_partition(qos, static_cast<std::uint32_t>(names.size()), names.data());
}

}  // namespace

Qos MakeQos(bool reliable, int max_blocking_ms, int history_depth, const std::string& partitions) {
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
  // Ends are told by disposing; a publisher that dies shall look different.
  dds_qset_writer_data_lifecycle(qos.get(), false);
  if (!partitions.empty()) SetPartitions(qos.get(), partitions);
  return qos;
}

}  // namespace windhover
