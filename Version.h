// The version of the headers. CMake reads it here. Before 1.0, each minor version may change the interface.
#pragma once

#define FULCRUM_VERSION_MAJOR 0
#define FULCRUM_VERSION_MINOR 2
#define FULCRUM_VERSION_PATCH 0

// To be compared: major * 10000 + minor * 100 + patch.
#define FULCRUM_VERSION (FULCRUM_VERSION_MAJOR * 10000 + FULCRUM_VERSION_MINOR * 100 + FULCRUM_VERSION_PATCH)

#define FULCRUM_VERSION_TEXT_OF(number) #number
#define FULCRUM_VERSION_TEXT(major, minor, patch) \
    FULCRUM_VERSION_TEXT_OF(major) "." FULCRUM_VERSION_TEXT_OF(minor) "." FULCRUM_VERSION_TEXT_OF(patch)
// "0.2.0"
#define FULCRUM_VERSION_STRING FULCRUM_VERSION_TEXT(FULCRUM_VERSION_MAJOR, FULCRUM_VERSION_MINOR, FULCRUM_VERSION_PATCH)
