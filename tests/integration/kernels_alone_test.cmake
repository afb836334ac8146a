# SPDX-License-Identifier: Apache-2.0
# cmake -D SOURCE=<repository> -D WORK=<folder to use> -P kernels_alone_test.cmake
# The operators, their tests and their benchmark configure where every other package is hidden.
set(hidden Eigen3 OpenCV CycloneDDS spdlog CLI11 nlohmann_json PkgConfig Python3)
list(TRANSFORM hidden REPLACE "(.+)" "-DCMAKE_DISABLE_FIND_PACKAGE_\\1=ON")
file(REMOVE_RECURSE ${WORK})

# A package that is asked for by another name, or without find_package, shows in the trace.
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK} -G Ninja -DWINDHOVER_KERNELS_ONLY=ON
          -DWINDHOVER_FFTW=AUTO ${hidden} --trace-expand --trace-redirect=${WORK}.trace
  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "The operators do not configure alone:\n${output}")
endif()
if(NOT output MATCHES "FFTW3 \\(fftw3f\\) was not found")
  message(FATAL_ERROR "FFTW3 was found without pkg-config, or its absence goes unsaid:\n${output}")
endif()
file(STRINGS ${WORK}.trace calls REGEX "  (find_package|pkg_check_modules)\\(")
foreach(call IN LISTS calls)
  if(NOT call MATCHES "find_package\\((OpenCL|GTest|Threads|PkgConfig) ")
    message(FATAL_ERROR "The operators ask for more than they may: ${call}")
  endif()
endforeach()

execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK} --target help OUTPUT_VARIABLE targets)
foreach(program backend_test phase_correlation_test kernels_bench)
  if(NOT targets MATCHES "[\n ]${program}:")
    message(FATAL_ERROR "${program} is not among the targets of the operators alone")
  endif()
endforeach()
