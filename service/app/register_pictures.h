// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "service/options/options.h"

namespace windhover {

struct RegisterOptions {
  std::string a;  // picture files
  std::string b;
  std::string out;  // folder for the results; empty writes none
  bool json = false;
  std::string device;  // see Backend::Create
  RegistrationOptions registration;
};

// Registers picture a to picture b, prints how they lie over each other and, where a folder is
// given, writes result.json and, unless registration is lost, blended.png and difference.png into
// it: all of them complete or none.
// Returns the exit code. Throws OptionError where the pictures are too small for the tiles,
// DeviceError, or std::runtime_error with one line of text that names the file that is to blame.
int RegisterPictures(const RegisterOptions& options);

}  // namespace windhover
