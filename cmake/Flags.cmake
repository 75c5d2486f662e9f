# Compiler flags of the targets of this repository; none of these reaches the code of users.

# Sets FULCRUM_SIMD_FLAGS from FULCRUM_SIMD. AVX2 without FMA: fused operations would change the bits.
function(fulcrum_choose_lanes)
  set(flags "")
  if(FULCRUM_SIMD STREQUAL "SCALAR")
    set(flags -DFULCRUM_SCALAR_LANES)
  elseif(FULCRUM_SIMD STREQUAL "AVX2")
    set(flags -mavx2)
  elseif(FULCRUM_SIMD STREQUAL "AUTO")
    if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64" AND NOT CMAKE_CROSSCOMPILING)
      include(CheckCXXSourceRuns)
      set(CMAKE_REQUIRED_FLAGS -mavx2)
      check_cxx_source_runs("int main() { return __builtin_cpu_supports(\"avx2\") ? 0 : 1; }" FULCRUM_HOST_HAS_AVX2)
      if(FULCRUM_HOST_HAS_AVX2)
        set(flags -mavx2)
      endif()
    endif()
  elseif(NOT FULCRUM_SIMD STREQUAL "SSE2")
    message(FATAL_ERROR "FULCRUM_SIMD is '${FULCRUM_SIMD}'; it must be AUTO, SCALAR, SSE2 or AVX2.")
  endif()
  # GCC copies eight lanes as two halves unless it is told that it may move them whole, and reading the whole after that waits
  # for both: a third of the time of the joint kernels, a tenth of a step of stacked boxes. The bits are the same.
  if("-mavx2" IN_LIST flags)
    include(CheckCXXCompilerFlag)
    check_cxx_compiler_flag(-mmove-max=256 FULCRUM_MOVES_WHOLE_LANES)
    if(FULCRUM_MOVES_WHOLE_LANES)
      list(APPEND flags -mmove-max=256 -mstore-max=256)
    endif()
  endif()
  set(FULCRUM_SIMD_FLAGS ${flags} PARENT_SCOPE)
endfunction()

fulcrum_choose_lanes()

# For every target of this repository: the flags of the lanes, assertions where chosen, warnings.
function(fulcrum_compile_options target)
  target_compile_features(${target} PRIVATE cxx_std_20)
  target_compile_options(${target} PRIVATE
    -fno-math-errno -fno-trapping-math ${FULCRUM_SIMD_FLAGS}
    -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -Wno-psabi
    # Masks, not branches: a | b on bools is meant.
    $<$<CXX_COMPILER_ID:Clang,AppleClang>:-Wno-bitwise-instead-of-logical>)
  if(FULCRUM_WARNINGS_AS_ERRORS)
    # But not those that GCC guesses after inlining: through Eigen it guesses wrong.
    target_compile_options(${target} PRIVATE -Werror
      $<$<CXX_COMPILER_ID:GNU>:-Wno-error=array-bounds -Wno-error=maybe-uninitialized>)
  endif()
  if(FULCRUM_ASSERTIONS)
    target_compile_definitions(${target} PRIVATE FULCRUM_ASSERTIONS)
  endif()
endfunction()

# Compiles about ten files of a library at once, where FULCRUM_UNITY asks for it.
function(fulcrum_unity target)
  if(FULCRUM_UNITY)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 10)
    # A local name would shadow one that another file of the same unit has at namespace scope.
    target_compile_options(${target} PRIVATE -Wno-shadow)
  endif()
endfunction()

# For what builds scenes, writes reports and tests: it runs once, and compiles in two thirds of the time with few optimizations.
# The engine keeps its own; so does every configuration but Release.
function(fulcrum_optimize_little target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()
