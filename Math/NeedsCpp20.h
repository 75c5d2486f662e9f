// Stops a compiler that was not told to compile C++20, with one error in place of a thousand. Included first by the
// public headers that include no others of the library, and so by all of them. A missing file is the error that stops
// every compiler at once.
#pragma once

#if defined(_MSVC_LANG) ? _MSVC_LANG < 202002L : __cplusplus < 202002L
#include <Fulcrum needs C++20; compile with -std=c++20 or later>
#endif
