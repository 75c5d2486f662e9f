// A hold belongs to the thread that began it.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <thread>

namespace fulcrum::testing {
namespace {

// Not among the parity tests: such a test starts its program again, which an emulator of processors does not.
TEST(HoldsDeathTest, EndOnTheirOwnThread) {
    ::testing::FLAGS_gtest_death_test_style = "threadsafe";
    EXPECT_DEATH(
        {
            TestWorld world;
            const auto* held = new auto(world.System().Queries().Hold());
            std::thread([&] { delete held; }).join();
        },
        "end on the thread that began them");
}

}  // namespace
}  // namespace fulcrum::testing
