# The engine's five targets, and Assets beside them. Sources are found by folder: a new file needs no line here.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Threads REQUIRED)
if(FULCRUM_LIBCCD)
  find_package(ccd REQUIRED)
endif()

# Users include <Fulcrum/Physics/PhysicsSystem.h>, in tree and installed alike.
set(FULCRUM_INCLUDE_ROOT ${CMAKE_CURRENT_BINARY_DIR}/include)
file(MAKE_DIRECTORY ${FULCRUM_INCLUDE_ROOT})
file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${FULCRUM_INCLUDE_ROOT}/Fulcrum SYMBOLIC)

# What the headers ask of whoever includes them. Their inline functions are compiled by users too, and the linker keeps
# one copy of each: it must compute the same bits, so nobody may contract a product and a sum.
function(fulcrum_usage_requirements target scope)
  target_compile_features(${target} ${scope} cxx_std_20)
  target_compile_options(${target} ${scope} $<$<CXX_COMPILER_ID:GNU,Clang,AppleClang>:-ffp-contract=off>)
  target_include_directories(${target} ${scope} $<BUILD_INTERFACE:${FULCRUM_INCLUDE_ROOT}>)
  # Includes go through a link, whose folder may be a clone called fulcrum.
  target_compile_options(${target} ${scope}
    $<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:Clang,AppleClang>:-Wno-nonportable-include-path>>)
endfunction()

# Libraries are static, or shared where BUILD_SHARED_LIBS is set. A plugin may link static ones too, so they are
# position-independent unless CMAKE_POSITION_INDEPENDENT_CODE says otherwise. A program executes the same number of
# instructions as without, since GCC is told that no function will be replaced by one of another library: it would inline none
# of them otherwise.
function(fulcrum_library_properties target)
  if(NOT DEFINED CMAKE_POSITION_INDEPENDENT_CODE)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fno-semantic-interposition>)
  # LLVM 14's vectorizer of straight-line code makes wrong code for WebAssembly: of the trees of joints, for one. To be said after -O2.
  if(EMSCRIPTEN)
    target_compile_options(${target} PRIVATE -fno-slp-vectorize)
  endif()
  set_target_properties(${target} PROPERTIES
    DEFINE_SYMBOL ""
    VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  fulcrum_unity(${target})
  # The five find each other wherever they are installed.
  if(NOT DEFINED CMAKE_INSTALL_RPATH)
    set_target_properties(${target} PROPERTIES INSTALL_RPATH "$<IF:$<PLATFORM_ID:Darwin>,@loader_path,$ORIGIN>")
  endif()
endfunction()

# A folder of headers alone (Math) becomes an interface library. PRECOMPILED: the headers that most of its files include; nine
# tenths of the time that such a file takes goes into reading them.
function(fulcrum_library folder)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "PUBLIC;PRIVATE;PRECOMPILED")
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cpp)
  if(FULCRUM_LIBCCD)
    list(FILTER sources EXCLUDE REGEX "/WithoutLibccd\\.cpp$")
  else()
    list(FILTER sources EXCLUDE REGEX "/Libccd\\.cpp$")
  endif()
  if(sources)
    add_library(Fulcrum${folder} ${sources})
    fulcrum_compile_options(Fulcrum${folder})
    fulcrum_library_properties(Fulcrum${folder})
    fulcrum_usage_requirements(Fulcrum${folder} PUBLIC)
    target_link_libraries(Fulcrum${folder} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
    if(ARG_PRECOMPILED)
      target_precompile_headers(Fulcrum${folder} PRIVATE ${ARG_PRECOMPILED})
    endif()
  else()
    add_library(Fulcrum${folder} INTERFACE)
    fulcrum_usage_requirements(Fulcrum${folder} INTERFACE)
    target_link_libraries(Fulcrum${folder} INTERFACE ${ARG_PUBLIC} ${ARG_PRIVATE})
  endif()
  add_library(Fulcrum::${folder} ALIAS Fulcrum${folder})
  set_target_properties(Fulcrum${folder} PROPERTIES EXPORT_NAME ${folder})
endfunction()

# Eigen composes stiffnesses of joints. No public header includes it, so programs do without.
fulcrum_library(Math)
fulcrum_library(Jobs PUBLIC Fulcrum::Math Threads::Threads)
fulcrum_library(Collision PUBLIC Fulcrum::Math PRIVATE $<$<BOOL:${FULCRUM_LIBCCD}>:ccd>
  PRECOMPILED <algorithm> <Fulcrum/Collision/NarrowPhase/SurfaceContact.h>)
fulcrum_library(Constraints PUBLIC Fulcrum::Math Fulcrum::Jobs
  PRECOMPILED <algorithm> <Fulcrum/Constraints/Joints/JointBatch.h>)
# The kernels are long enough alone.
set_source_files_properties(Constraints/Joints/SolveJoints.cpp Constraints/Joints/PrepareJoints.cpp Constraints/Joints/SolveBalls.cpp
  Constraints/Contacts/SolveContacts.cpp Constraints/Contacts/PrepareContacts.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
fulcrum_library(Physics PUBLIC Fulcrum::Collision Fulcrum::Constraints Fulcrum::Jobs PRIVATE $<BUILD_INTERFACE:Eigen3::Eigen>
  PRECOMPILED <Fulcrum/Physics/PhysicsSystem.h> <Fulcrum/Physics/Stages/StepState.h>)

# Files of scenes, ragdolls and meshes: the only library of ours that needs other packages than the engine. The samples use it.
if(FULCRUM_BUILD_SAMPLES OR FULCRUM_BUILD_BENCHMARKS)
  set(FULCRUM_BUILD_ASSETS ON)
endif()
if(FULCRUM_BUILD_ASSETS)
  find_package(nlohmann_json REQUIRED)
  find_package(assimp REQUIRED)
  fulcrum_library(Assets PUBLIC Fulcrum::Physics nlohmann_json::nlohmann_json
    PRIVATE assimp::assimp $<BUILD_INTERFACE:Eigen3::Eigen>
    PRECOMPILED <nlohmann/json.hpp> <Fulcrum/Assets/SceneDescription.h>)
  fulcrum_optimize_little(FulcrumAssets)
endif()
