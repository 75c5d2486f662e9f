// What a program hangs into the engine: an observer of steps, a handler of what is logged.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <string>

namespace fulcrum::testing {
namespace {

class Listing final : public StepObserver {
public:
    void BeginStep(uint64_t step) override { log += "step " + std::to_string(step) + "\n"; }
    void EndStep(uint64_t step) override { log += "end " + std::to_string(step) + "\n"; }
    void BeginStage(int stage, const char* name) override {
        log += name;
        EXPECT_EQ(stage, began++);
        EXPECT_STREQ(name, StageName(stage));
    }
    void EndStage(int stage, const char*) override {
        log += ".\n";
        EXPECT_EQ(stage, began - 1);
    }
    std::string log;
    int began = 0;
};

TEST(StepObserver, IsToldOfEachStageInOrder) {
    TestWorld world;
    Listing listing;
    world.System().SetStepObserver(&listing);
    world.Step();
    std::string expected = "step 1\n";
    for (int stage = 0; stage < kStageCount; ++stage) expected += std::string(StageName(stage)) + ".\n";
    EXPECT_EQ(listing.log, expected + "end 1\n");
    listing.log.clear();
    world.Step(0);  // no stage runs
    EXPECT_EQ(listing.log, "step 2\nend 2\n");
    world.System().SetStepObserver(nullptr);
    listing.log.clear();
    world.Step();
    EXPECT_EQ(listing.log, "");
}

std::string theLog;
void KeepLine(LogLevel level, const char* line) {
    theLog += (level == LogLevel::Fatal ? "fatal: " : "warning: ") + std::string(line);
}

TEST(Log, MisuseGoesToTheHandler) {
    TestWorld world;
    SetLogHandler(KeepLine);
    theLog.clear();
    EXPECT_FALSE(world.System().Queries().IsOverlapping(PlacedShape{}));
    SetLogHandler(nullptr);
    EXPECT_EQ(theLog.rfind("warning: the shape of a query is null", 0), 0u) << theLog;
}

void PrintLine(LogLevel, const char* line) { std::fprintf(stderr, "my log: %s\n", line); }

TEST(LogDeathTest, AnErrorThatIsNotLookedAtSaysWhatItWasBeforeItStops) {
    const auto ask = [] {
        SetLogHandler(PrintLine);
        TestWorld world;
        (void)world.Bodies().Create({}).Value();
    };
    EXPECT_DEATH(ask(), "my log: Value\\(\\) of an error: shape is null");
}

// The value of a temporary is moved out, and lives on.
TEST(Result, OfATemporaryGivesItsValue) {
    const auto make = []() -> Result<std::unique_ptr<int>> { return std::make_unique<int>(7); };
    const std::unique_ptr<int> value = make().Value();
    EXPECT_EQ(*value, 7);
    const auto& kept = Result<std::string>(std::string(100, 'x')).Value();
    EXPECT_EQ(kept, std::string(100, 'x'));
    static_assert(!std::is_lvalue_reference_v<decltype(std::declval<Result<int>>().Value())>);
}

}  // namespace
}  // namespace fulcrum::testing
