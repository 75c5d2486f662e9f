// Random arguments of calls: ordinary ones and extremes, as the program's style says. They depend on one seed alone, so
// that a call has the same arguments whatever calls precede it. One thread.
#pragma once

#include <Fulcrum/Math/Pose.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <cmath>
#include <limits>

namespace fulcrum::testing {

// What kinds of arguments a program may have beside ordinary ones. All are on; one that is switched off stands for a
// known failure that is not fixed yet.
struct RandomStyle {
    float oddChance = 0;          // of each number, to be an extreme one
    bool notFinite = true;        // NaN and infinity among the extremes
    bool extremeSpeeds = true;    // m/s and rad/s up to 1e30
    bool extremeForces = true;    // forces, impulses, masses and inertias up to 1e30
    bool extremePlaces = true;    // m, up to 1e30
    bool extremeSizes = true;     // of shapes, 1e-6 .. 1e6 m
    bool extremeSettings = true;  // of system, materials, springs, limits
    bool badEnumerators = true;   // values that no enumerator has
    bool nullShapes = true;       // queries of no shape
    bool joints = true, ragdolls = true, sensors = true, continuous = true;
    bool changeSettings = true;  // SetSettings in the middle
};

class Values {
public:
    Values(uint32_t seed, const RandomStyle& style) : random_(seed), style_(style) {}

    RandomPoses& Random() { return random_; }
    const RandomStyle& Style() const { return style_; }
    bool IsOdd() { return random_.Chance(style_.oddChance); }
    bool Chance(float probability) { return random_.Chance(probability); }
    uint32_t Below(uint32_t count) { return random_.Below(count); }
    float Between(float low, float high) { return random_.Between(low, high); }

    // Between low and high, or, where `odd` may be, an extreme one of any sign.
    float Number(float low, float high, bool odd) { return odd && IsOdd() ? Extreme() : Between(low, high); }
    float Speed(float most) { return Number(-most, most, style_.extremeSpeeds); }
    float Force(float most) { return Number(-most, most, style_.extremeForces); }
    float Setting(float low, float high) { return Number(low, high, style_.extremeSettings); }
    int Integer(int low, int high) {
        constexpr int kExtremes[] = {-1, 0, 1000, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()};
        if (style_.extremeSettings && IsOdd()) return kExtremes[Below(5)];
        return low + static_cast<int>(Below(static_cast<uint32_t>(high - low + 1)));
    }
    float Mass() { return style_.extremeForces && IsOdd() ? Extreme() : Between(0.1f, 20); }
    // A half size, m; extremes are positive but for a few.
    float Size() {
        if (!style_.extremeSizes || !IsOdd()) return Between(0.1f, 0.6f);
        return Chance(0.05f) ? Extreme() : PowerOfTen(-6, 6);
    }
    Vector3 Sizes() {
        const float x = Size(), y = Size();
        return Vector3(x, y, Size());
    }
    Vector3 Speeds(float most) {
        const float x = Speed(most), y = Speed(most);
        return Vector3(x, y, Speed(most));
    }
    Vector3 Forces(float most) {
        const float x = Force(most), y = Force(most);
        return Vector3(x, y, Force(most));
    }
    double Coordinate(float most) {
        if (!style_.extremePlaces || !IsOdd()) return double{Between(-most, most)};
        return Chance(0.1f) ? double{Extreme()} * 1e60 : double{Extreme()};
    }
    Position Place(float most) {
        const double x = Coordinate(most), y = Coordinate(most) + double{most};
        return Position(x, y, Coordinate(most));
    }
    Vector3 Offset(float most) {
        const float x = Number(-most, most, style_.extremePlaces), y = Number(-most, most, style_.extremePlaces);
        return Vector3(x, y, Number(-most, most, style_.extremePlaces));
    }
    Quaternion Rotation() {
        if (IsOdd()) return {Extreme(), Between(-1, 1), 0, Between(-1, 1)};
        return Chance(0.3f) ? Quaternion{} : Chance(0.3f) ? random_.QuarterTurns() : random_.Rotation();
    }
    // One of the first `count` enumerators, rarely one beyond.
    template <class Enumerator>
    Enumerator One(uint32_t count) {
        const bool bad = style_.badEnumerators && IsOdd();
        return static_cast<Enumerator>(bad ? count + Below(256 - count) : Below(count));
    }

    float PowerOfTen(int lowest, int highest) {
        return std::pow(10.0f, Between(static_cast<float>(lowest), static_cast<float>(highest)));
    }
    float Extreme() {
        const float sign = Chance(0.5f) ? -1.0f : 1.0f;
        switch (Below(style_.notFinite ? 8 : 6)) {
            case 0: return sign * 0.0f;
            case 1: return sign * PowerOfTen(-30, -3);
            case 2: return sign * PowerOfTen(2, 8);
            case 3: return sign * PowerOfTen(8, 30);
            case 4: return sign * 3e38f;
            case 5: return sign * 1e-40f;
            case 6: return sign * std::numeric_limits<float>::infinity();
            default: return std::numeric_limits<float>::quiet_NaN();
        }
    }

private:
    RandomPoses random_;
    const RandomStyle& style_;
};

}  // namespace fulcrum::testing
