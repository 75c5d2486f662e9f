// Runs code that may deadlock: then the test program ends with a message instead of hanging.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <future>

namespace fulcrum::testing {

// A blocked thread cannot be ended, so the program is.
template <class Call>
void Within(double seconds, const Call& call) {
    std::future<void> done = std::async(std::launch::async, call);
    if (done.wait_for(std::chrono::duration<double>(seconds)) != std::future_status::ready) {
        std::fprintf(stderr, "%s did not return within %g s\n",
                     ::testing::UnitTest::GetInstance()->current_test_info()->name(), seconds);
        std::_Exit(EXIT_FAILURE);
    }
    done.get();
}

}  // namespace fulcrum::testing
