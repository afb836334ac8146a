# SPDX-License-Identifier: Apache-2.0
# cmake -D PRINT_OPTIONS=<program> -D README=<file> -P options_readme_check.cmake
# Fails if the README is not what the program prints.
execute_process(COMMAND ${PRINT_OPTIONS} OUTPUT_VARIABLE printed COMMAND_ERROR_IS_FATAL ANY)
file(READ ${README} written)
if(NOT printed STREQUAL written)
  message(FATAL_ERROR "${README} is not what the option structs say: ninja options_readme")
endif()
