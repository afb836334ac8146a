# SPDX-License-Identifier: Apache-2.0
# cmake -D BUILD=<build folder> -D CONSUMER=<source folder> -D WORK=<folder to use> -P install_test.cmake
# Installs, moves the installed tree, builds somebody else's project against it and runs that.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

function(expect_file pattern)
  file(GLOB found ${WORK}/prefix/${pattern})
  if(NOT found)
    message(FATAL_ERROR "Nothing like ${pattern} was installed")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/first)
file(RENAME ${WORK}/first ${WORK}/prefix)
foreach(file bin/windhover bin/windhover-replay include/windhover/service/vision/types.h
             share/windhover/idl/detections.idl)
  expect_file(${file})
endforeach()
expect_file(${LIBDIR}/gstreamer-1.0/libgstwindhover.so)
expect_file(${LIBDIR}/pkgconfig/windhover.pc)

set(ENV{PKG_CONFIG_PATH} ${WORK}/prefix/${LIBDIR}/pkgconfig)
run(${CMAKE_COMMAND} -S ${CONSUMER} -B ${WORK}/build -G Ninja
    -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=${WORK}/prefix)
run(${CMAKE_COMMAND} --build ${WORK}/build)
foreach(program by_package by_pkg_config)
  run(${WORK}/build/${program})
  if(NOT output MATCHES "^5\\.0 -?0\\.0\n$")  # the sign of a shift of nothing is chance
    message(FATAL_ERROR "${program} measured a shift of ${output} instead of 5.0 0.0")
  endif()
endforeach()

run(${WORK}/prefix/bin/windhover --version)
set(ENV{GST_PLUGIN_PATH} ${WORK}/prefix/${LIBDIR}/gstreamer-1.0)
set(ENV{GST_REGISTRY} ${WORK}/registry.bin)
run(gst-inspect-1.0 whregister)
