# SPDX-License-Identifier: Apache-2.0
# WINDHOVER_HAS_FFTW and the target PkgConfig::FFTW3F, as WINDHOVER_FFTW asks for.

set(WINDHOVER_FFTW ON CACHE STRING
    "FFTW3 for the CPU twin's transforms: ON, OFF (a slower one of our own), AUTO (where it is installed)")
set_property(CACHE WINDHOVER_FFTW PROPERTY STRINGS ON OFF AUTO)

set(WINDHOVER_HAS_FFTW OFF)
if(WINDHOVER_FFTW STREQUAL "AUTO")
  find_package(PkgConfig QUIET)
  if(PKG_CONFIG_FOUND)
    pkg_check_modules(FFTW3F QUIET IMPORTED_TARGET fftw3f)
  endif()
  if(TARGET PkgConfig::FFTW3F)
    set(WINDHOVER_HAS_FFTW ON)
  else()
    message(STATUS "FFTW3 (fftw3f) was not found: the CPU twin takes a slower transform of our own")
  endif()
elseif(WINDHOVER_FFTW)
  find_package(PkgConfig REQUIRED)
  pkg_check_modules(FFTW3F REQUIRED IMPORTED_TARGET fftw3f)
  set(WINDHOVER_HAS_FFTW ON)
endif()
