// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/option_list.h"

#include "service/options/options.h"

namespace windhover::replay {
namespace {

using Options = std::vector<std::pair<std::string, std::string>>;

template <typename S>
void Append(const S& options, Options& list) {
  ForEachField<S>([&](const auto& field) {
    const std::string name(field.name);
    list.emplace_back(name, OptionText(options, name));
  });
}

}  // namespace

Options OptionList(int frames) {
  Options list;
  list.emplace_back("frames", frames > 0 ? std::to_string(frames) : "all");
  Append(RegistrationOptions(), list);
  Append(BackgroundOptions(), list);
  Append(MotionOptions(), list);
  return list;
}

}  // namespace windhover::replay
