# SPDX-License-Identifier: Apache-2.0
# Embeds OpenCL sources, word for word.
#
# windhover_embed_kernels(OUTPUT_VARIABLE FILE.cl...) appends to OUTPUT_VARIABLE one generated .cc
# a file, which defines windhover::k<FileName>Cl as declared in
# gpu-kernels/opencl/kernel_sources.h. Made anew whenever the .cl file changes. A #line comes first,
# so that the OpenCL compiler's messages name the file and its own line numbers.
#
# As a script (cmake -DSOURCE=in.cl -DDESTINATION=out.cc -P EmbedKernels.cmake) it makes one such .cc.

if(CMAKE_SCRIPT_MODE_FILE)
  get_filename_component(file_name ${SOURCE} NAME)
  get_filename_component(stem ${SOURCE} NAME_WE)
  string(REPLACE "_" ";" words ${stem})
  set(variable k)
  foreach(word IN LISTS words)
    string(SUBSTRING ${word} 0 1 first)
    string(SUBSTRING ${word} 1 -1 rest)
    string(TOUPPER ${first} first)
    string(APPEND variable ${first}${rest})
  endforeach()
  string(APPEND variable Cl)

  file(READ ${SOURCE} content HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," content "${content}")
  string(REGEX REPLACE "((......,){16})" "\\1\n" content "${content}")
  set(line "#line 1 \"${file_name}\"\n")
  string(HEX "${line}" line)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," line "${line}")
  file(WRITE ${DESTINATION}
"#include \"gpu-kernels/opencl/kernel_sources.h\"

namespace windhover {
namespace {

constexpr char kText[] = {
${line}
${content}'\\0'};

}  // namespace

constinit const std::string_view ${variable}(kText, sizeof(kText) - 1);

}  // namespace windhover
")
  return()
endif()

set(WINDHOVER_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_FILE})

function(windhover_embed_kernels output_variable)
  set(outputs ${${output_variable}})
  foreach(source IN LISTS ARGN)
    get_filename_component(stem ${source} NAME_WE)
    set(destination ${CMAKE_CURRENT_BINARY_DIR}/${stem}_cl.cc)
    add_custom_command(
      OUTPUT ${destination}
      COMMAND ${CMAKE_COMMAND} -DSOURCE=${CMAKE_CURRENT_SOURCE_DIR}/${source}
              -DDESTINATION=${destination} -P ${WINDHOVER_EMBED_SCRIPT}
      DEPENDS ${source} ${WINDHOVER_EMBED_SCRIPT}
      COMMENT "Embedding ${source}"
      VERBATIM)
    list(APPEND outputs ${destination})
  endforeach()
  set(${output_variable} ${outputs} PARENT_SCOPE)
endfunction()
