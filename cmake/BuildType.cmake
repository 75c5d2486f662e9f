# Unoptimized, the engine is tens of times slower. Where nobody has said how to compile (no build type, no -O among the flags, a
# generator of one configuration), it is Release; inside another project for the engine alone, the project's own stays unset.
get_property(multi_config GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
if(NOT multi_config AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CXX_FLAGS MATCHES "(^| )-O")
  if(PROJECT_IS_TOP_LEVEL)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug, Release, RelWithDebInfo or MinSizeRel" FORCE)
  else()
    set(CMAKE_BUILD_TYPE Release)
    message(STATUS "Fulcrum: no CMAKE_BUILD_TYPE is set, so the engine is compiled as Release")
  endif()
endif()
