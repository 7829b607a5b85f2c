# How a module, its tests and the version header are built.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
# Asserts stay on in every build: a broken invariant has to stop the run, not bend its result.
set(CMAKE_CXX_FLAGS_RELEASE "-O3")

option(SUNDER_PORTABLE "Build for any x86-64 machine instead of x86-64-v3 (AVX2, FMA)" OFF)

add_library(sunder_flags INTERFACE)
# Contraction to FMA is off so that the same source gives the same bits at every optimisation level.
target_compile_options(sunder_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -ffp-contract=off)
if(NOT SUNDER_PORTABLE AND CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  # For all modules alike: Eigen's alignment follows the instruction set and must agree across libraries.
  target_compile_options(sunder_flags INTERFACE -march=x86-64-v3)
endif()
target_include_directories(sunder_flags INTERFACE ${PROJECT_SOURCE_DIR})

find_program(CCACHE ccache)
if(CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

# For targets that look for files of the checkout. Modules do not: they compile to the same objects in any checkout, so a
# compiler cache serves them all.
set(SUNDER_SOURCE_DEFINITION SUNDER_SOURCE_DIR="${PROJECT_SOURCE_DIR}")

# sunder_module(name USES public-dependencies HIDES third-party-inside-cpp-files)
function(sunder_module name)
  cmake_parse_arguments(ARG "" "" "USES;HIDES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${name}/*.cpp ${PROJECT_SOURCE_DIR}/${name}/detail/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
  add_library(sunder_${name} STATIC ${sources})
  target_link_libraries(sunder_${name} PUBLIC sunder_flags ${ARG_USES} PRIVATE ${ARG_HIDES})
endfunction()

# sunder_embedded_text(module file symbol): the file's text as std::string_view sunder::<module>::detail::<symbol>, declared nowhere but
# where it is used.
function(sunder_embedded_text module file symbol)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${file})
  file(READ ${PROJECT_SOURCE_DIR}/${file} text)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/embedded_text.cpp.in ${PROJECT_BINARY_DIR}/generated/${symbol}.cpp @ONLY)
  target_sources(sunder_${module} PRIVATE ${PROJECT_BINARY_DIR}/generated/${symbol}.cpp)
endfunction()

# sunder_test(name): every tests/<name>/*_test.cpp in one program; extra libraries follow the name. Sources of the folder
# that are not tests serve them. Suites with Slow in their name get the label slow.
function(sunder_test name)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(${name}_tests ${sources})
  target_compile_definitions(${name}_tests PRIVATE ${SUNDER_SOURCE_DEFINITION})
  target_link_libraries(${name}_tests PRIVATE ${ARGN} GTest::gtest_main rapidcheck rapidcheck_gtest)
  gtest_discover_tests(${name}_tests TEST_PREFIX ${name}. DISCOVERY_MODE PRE_TEST TEST_FILTER -*Slow*
                       TEST_LIST ${name}_fast PROPERTIES TIMEOUT 300)
  gtest_discover_tests(${name}_tests TEST_PREFIX ${name}. DISCOVERY_MODE PRE_TEST TEST_FILTER *Slow*
                       TEST_LIST ${name}_slow PROPERTIES TIMEOUT 900 LABELS slow)
endfunction()

# Writes generated/sunder_version.h with the version and, at every build, the git revision with its dirty flag.
function(sunder_version_header)
  add_custom_target(sunder_version_header ALL
    COMMAND ${CMAKE_COMMAND} -DSOURCE=${PROJECT_SOURCE_DIR} -DVERSION=${PROJECT_VERSION}
            -DOUTPUT=${PROJECT_BINARY_DIR}/generated/sunder_version.h -P ${PROJECT_SOURCE_DIR}/cmake/version.cmake
    BYPRODUCTS ${PROJECT_BINARY_DIR}/generated/sunder_version.h COMMENT "")
  target_include_directories(sunder_pipeline PRIVATE ${PROJECT_BINARY_DIR}/generated)
  add_dependencies(sunder_pipeline sunder_version_header)
endfunction()

# The pass over a block of particles once per instruction set; the best of the machine is chosen when the program runs.
# FMA is explicit in no source: both sets that have it contract the same expressions, so they give the same bits.
function(sunder_instruction_sets)
  set(portable -march=x86-64 -Wno-psabi)
  set(avx2 -march=x86-64-v3)
  set(avx512 -march=x86-64-v4 -mprefer-vector-width=512)
  foreach(set portable avx2 avx512)
    set(source ${PROJECT_SOURCE_DIR}/mpm/detail/block_pass_${set}.cpp)
    if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
      set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS
        "${${set}};-ffp-contract=fast;-fno-math-errno;-fno-trapping-math")
    elseif(NOT set STREQUAL portable)
      set_source_files_properties(${source} PROPERTIES HEADER_FILE_ONLY ON)
    endif()
  endforeach()
endfunction()

# bin/sunder_without_effects: the program without optional effects, with whose cost a test compares it. Only the sources that ask
# core/optional_effects.h are compiled once more; they win over those in the libraries, which are not asked any more.
function(sunder_without_effects)
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/*/*.cpp)
  set(hooked ${PROJECT_SOURCE_DIR}/cli/main.cpp)
  foreach(source ${sources})
    file(STRINGS ${source} mentions REGEX with_optional_effects)
    if(mentions)
      list(APPEND hooked ${source})
    endif()
  endforeach()
  file(GLOB passes CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/mpm/detail/block_pass_*.cpp)
  add_executable(sunder_without_effects ${hooked} ${passes})
  target_compile_definitions(sunder_without_effects PRIVATE SUNDER_WITHOUT_EFFECTS)
  target_link_libraries(sunder_without_effects PRIVATE sunder_cli TBB::tbb)
endfunction()
