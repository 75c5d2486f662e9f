// Point sets that hull tests share: round, boxy, coplanar, duplicated, nearly flat. Random by SplitMix64, so that every
// platform draws the same ones.
#pragma once

#include <Fulcrum/Math/Quaternion.h>

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace fulcrum::test {

inline constexpr double kPi = 3.14159265358979323846;

class Random {
public:
    explicit Random(uint64_t seed) : state_(seed) {}
    uint64_t Bits() {
        uint64_t z = (state_ += 0x9E3779B97F4A7C15ull);
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
        return z ^ (z >> 31);
    }
    int Below(int count) { return static_cast<int>(Bits() % static_cast<uint64_t>(count)); }
    double Unit() { return static_cast<double>(Bits() >> 11) * 0x1p-53; }
    double Symmetric() { return 2 * Unit() - 1; }
    Position InCube() {
        const double x = Symmetric(), y = Symmetric(), z = Symmetric();
        return {x, y, z};
    }
    Position InBall() {
        for (;;) {
            const Position p = InCube();
            const double squared = p.squaredNorm();
            if (squared <= 1 && squared > 1e-4) return p;
        }
    }
    Position OnSphere() { return InBall().normalized(); }
    Quaternion Rotation() {
        for (;;) {
            const Position a = InCube();
            const double w = Symmetric(), squared = a.squaredNorm() + w * w;
            if (squared > 1 || squared < 1e-2) continue;
            return Normalized(Quaternion{static_cast<float>(a.x()), static_cast<float>(a.y()),
                                         static_cast<float>(a.z()), static_cast<float>(w)});
        }
    }

private:
    uint64_t state_;
};

enum class PointSet {
    InBall,
    OnSphere,
    InCube,
    BoxGrid,
    TurnedBoxGrid,
    NoisyGrid,
    TurnedPrism,
    Duplicated,
    Flat1e5,
    Flat1e6,
    TurnedFlat1e5,
    Needle,
    Tiny,
    FarAway,
    Count
};

// One set of the kind: float coordinates of about 1 m, but for the kinds that say otherwise.
inline std::vector<Vector3> MakePointSet(PointSet kind, uint64_t seed) {
    Random random(seed * 64 + static_cast<uint64_t>(kind));
    const Quaternion turn = random.Rotation();
    const int count = 4 + random.Below(60);
    std::vector<Position> points;
    const auto fill = [&](auto draw) {
        while (static_cast<int>(points.size()) < count) points.push_back(draw());
    };
    const auto grid = [&] {
        const int side[3] = {2 + random.Below(4), 2 + random.Below(4), 2 + random.Below(4)};
        for (int x = 0; x < side[0]; ++x)
            for (int y = 0; y < side[1]; ++y)
                for (int z = 0; z < side[2]; ++z) points.emplace_back(0.5 * x, 0.3 * y, 0.4 * z);
    };
    const auto stretched = [&](double x, double y, double z) {
        return [&random, x, y, z] { return Position(random.InBall().cwiseProduct(Position(x, y, z))); };
    };
    bool turned = false;
    switch (kind) {
        case PointSet::InBall: fill([&] { return random.InBall(); }); break;
        case PointSet::OnSphere: fill([&] { return random.OnSphere(); }); break;
        case PointSet::InCube: fill([&] { return random.InCube(); }); break;
        case PointSet::BoxGrid: grid(); break;
        case PointSet::TurnedBoxGrid: grid(), turned = true; break;
        case PointSet::NoisyGrid: {
            // Noise around the tolerance, where merging is ambiguous.
            grid();
            const double noise = std::pow(10.0, -8 + 3 * random.Unit());
            for (Position& p : points) p += random.InCube() * noise;
            break;
        }
        case PointSet::TurnedPrism: {
            const int corners = 3 + random.Below(20);
            for (int i = 0; i < corners; ++i)
                for (int layer = 0; layer < 3; ++layer)
                    points.emplace_back(std::cos(2 * kPi * i / corners), 0.4 * layer, std::sin(2 * kPi * i / corners));
            turned = true;
            break;
        }
        case PointSet::Duplicated:
            for (int i = 0; i < count / 3 + 4; ++i) {
                const Position p = random.InCube();
                for (int copy = 0; copy < 3; ++copy) points.push_back(p + random.InCube() * 1e-7);
            }
            break;
        case PointSet::Flat1e5: fill(stretched(1, 1e-5, 1)); break;
        case PointSet::Flat1e6: fill(stretched(1, 1, 1e-6)); break;
        case PointSet::TurnedFlat1e5: fill(stretched(1, 1e-5, 1)), turned = true; break;
        case PointSet::Needle: fill(stretched(1e-4, 1, 1e-5)); break;
        case PointSet::Tiny: fill([&] { return Position(random.InCube() * 1e-7); }); break;
        case PointSet::FarAway: fill([&] { return Position(random.InCube() * 2 + Position(1e6, -1e6, 3e5)); }); break;
        case PointSet::Count: break;
    }
    std::vector<Vector3> result;
    for (const Position& p : points) {
        const Vector3 v = p.cast<float>();
        result.push_back(turned ? Rotate(turn, v) : v);
    }
    return result;
}

// `count` points spread evenly on a sphere: y falls by equal steps, longitude advances by the golden angle.
inline std::vector<Vector3> FibonacciSphere(int count, double radius) {
    std::vector<Vector3> points;
    for (int n = 0; n < count; ++n) {
        const double y = 1 - (2.0 * n + 1) / count, angle = n * kPi * (3 - std::sqrt(5.0)), r = std::sqrt(1 - y * y);
        points.push_back((Position(r * std::cos(angle), y, r * std::sin(angle)) * radius).cast<float>());
    }
    return points;
}

inline std::vector<Vector3> BoxCorners(const Vector3& halfExtents) {
    std::vector<Vector3> corners;
    for (int i = 0; i < 8; ++i) {
        corners.push_back(
            halfExtents.cwiseProduct(Vector3(i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f)));
    }
    return corners;
}

inline std::vector<Position> ToPositions(std::span<const Vector3> points) {
    std::vector<Position> positions;
    for (const Vector3& p : points) positions.push_back(p.cast<double>());
    return positions;
}

}  // namespace fulcrum::test
