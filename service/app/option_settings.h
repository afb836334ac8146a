// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "service/options/options.h"

namespace windhover {

// An option of the pipeline as the user sets it.
struct OptionSetting {
  std::string name;
  std::string value;
};

// Reads "option=value" and checks it against the option structs. Throws OptionError, which lists
// the options there are where the name is unknown, and says what the value may be where it is not
// right.
OptionSetting ParseOptionSetting(const std::string& text);

// Reads "option=value" and sets it. Throws OptionError as ParseOptionSetting, for options of
// registration only.
void SetRegistrationOption(const std::string& text, RegistrationOptions& options);

// One line an option, for people: name, default, range, unit and meaning.
std::string DescribeOptions();
std::string DescribeRegistrationOptions();

}  // namespace windhover
