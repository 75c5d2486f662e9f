// Callables kept by value, and results that hold what cannot be copied.
#include <Fulcrum/Math/Function.h>
#include <Fulcrum/Math/Result.h>

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>

namespace fulcrum {
namespace {

using IntFunction = Function<int(int)>;

int Twice(int x) { return 2 * x; }

TEST(Function, TakesWhatCanBeCalled) {
    int added = 3;
    EXPECT_EQ(IntFunction([added](int x) { return x + added; })(4), 7);
    EXPECT_EQ(IntFunction(Twice)(4), 8);
    EXPECT_EQ(IntFunction(&Twice)(4), 8);
    EXPECT_EQ(IntFunction(std::function<int(int)>(Twice))(4), 8);
    EXPECT_EQ(std::function<int(int)>(IntFunction(Twice))(4), 8);
}

TEST(Function, IsEmptyWhereWhatItTookIs) {
    EXPECT_FALSE(IntFunction());
    EXPECT_FALSE(IntFunction(nullptr));
    EXPECT_FALSE(IntFunction(std::function<int(int)>()));
    EXPECT_FALSE(IntFunction(static_cast<int (*)(int)>(nullptr)));
    IntFunction twice = Twice;
    EXPECT_TRUE(twice);
    twice = nullptr;
    EXPECT_FALSE(twice);
}

TEST(Function, CopiesShareTheCallable) {
    const IntFunction sum = [total = 0](int x) mutable { return total += x; };
    const IntFunction copy = sum;
    EXPECT_EQ(sum(2), 2);
    EXPECT_EQ(copy(3), 5);
}

TEST(Result, MovesWhatCannotBeCopied) {
    using Owner = Result<std::unique_ptr<int>>;
    static_assert(!std::is_copy_constructible_v<Owner> && !std::is_copy_assignable_v<Owner>);
    static_assert(std::is_nothrow_move_constructible_v<Owner>);
    Owner result = std::make_unique<int>(5);
    Owner moved = std::move(result);
    ASSERT_TRUE(moved);
    EXPECT_EQ(*moved.Value(), 5);
    moved = Error{ErrorCode::Negative, "below zero"};
    ASSERT_FALSE(moved);
    EXPECT_EQ(moved.GetError().message, "below zero");
    moved = std::make_unique<int>(6);
    EXPECT_EQ(*moved.Value(), 6);
}

TEST(Result, CopiesValuesAndErrors) {
    const Result<std::string> value = std::string(100, 'x'),
                              error = Error{ErrorCode::Degenerate, std::string(100, 'y')};
    Result<std::string> copy = value;
    EXPECT_EQ(copy.Value(), value.Value());
    copy = error;
    ASSERT_FALSE(copy);
    EXPECT_EQ(copy.GetError().code, ErrorCode::Degenerate);
    EXPECT_EQ(copy.GetError().message, error.GetError().message);
    copy = value;
    EXPECT_EQ(copy.Value(), std::string(100, 'x'));
}

}  // namespace
}  // namespace fulcrum
