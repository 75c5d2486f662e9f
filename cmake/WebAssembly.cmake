# Toolchain: WebAssembly with emscripten, Debian's or that of $ENV{EMSDK}. Browsers and node 16.4 or later run it (SIMD128).
foreach(root $ENV{EMSDK}/upstream/emscripten /usr/share/emscripten)
  if(EXISTS ${root}/cmake/Modules/Platform/Emscripten.cmake)
    include(${root}/cmake/Modules/Platform/Emscripten.cmake)
    break()
  endif()
endforeach()
if(NOT EMSCRIPTEN)
  message(FATAL_ERROR "emscripten is not installed (Debian: apt install emscripten) and EMSDK does not name it")
endif()

get_filename_component(FULCRUM_COMPATIBILITY ${CMAKE_CURRENT_LIST_DIR}/../Web/Compatibility ABSOLUTE)
# One compilation serves programs with and without threads. Sizes have 32 bits here.
set(CMAKE_CXX_FLAGS_INIT "-msimd128 -pthread -Wno-shorten-64-to-32 -isystem ${FULCRUM_COMPATIBILITY}")
# To link without threads. LLVM 14's linker adds the address of thread-local data twice then, which does not matter where it is 0.
set(FULCRUM_WITHOUT_THREADS -sUSE_PTHREADS=0 -sGLOBAL_BASE=0)
set(CMAKE_CXX_FLAGS_RELEASE_INIT "-O2 -DNDEBUG")
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG" CACHE STRING "")
set(CMAKE_POSITION_INDEPENDENT_CODE OFF)
# Headers alone, the same for every processor.
set(Eigen3_DIR /usr/share/eigen3/cmake CACHE PATH "")
set(FULCRUM_LIBCCD OFF CACHE BOOL "")
