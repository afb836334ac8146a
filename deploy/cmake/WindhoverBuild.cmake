# SPDX-License-Identifier: Apache-2.0
# How everything of ours is compiled, and where it lands.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")

# Sanitized builds reach third-party code through our own; they cannot use functions that are chosen
# by the processor at load time (WINDHOVER_MULTIVERSION).
if(WINDHOVER_SANITIZE)
  add_compile_options(-fsanitize=${WINDHOVER_SANITIZE} -fno-omit-frame-pointer
                      -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${WINDHOVER_SANITIZE})
  add_compile_definitions(WINDHOVER_SANITIZED _GLIBCXX_ASSERTIONS)
  # Assertions stay in. More than line numbers no report needs, and more optimisation costs more time in
  # the compiler than it saves in the tests.
  set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1")
endif()

# windhover_library(NAME SOURCES... [LINK PUBLIC|PRIVATE targets...]) makes the static library
# windhover_NAME, included from the repository's root and exported as windhover::NAME.
function(windhover_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_library(windhover_${name} STATIC ${ARG_SOURCES})
  add_library(windhover::${name} ALIAS windhover_${name})
  set_target_properties(windhover_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(windhover_${name} PUBLIC cxx_std_20)
  target_include_directories(windhover_${name} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/windhover>)
  target_link_libraries(windhover_${name} ${ARG_LINK})
  windhover_warnings(windhover_${name})
endfunction()

function(windhover_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wnon-virtual-dtor
                         -Woverloaded-virtual)
  # GCC 12 sees overlapping copies in std::string's operator+ where there are none (GCC bug 105651).
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
  if(WINDHOVER_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()
