#include <Fulcrum/Physics/Stages/ScaleWarmStarts.h>

#include <Fulcrum/Physics/Stages/BodyRows.h>

#include <algorithm>

namespace fulcrum {

namespace {

using namespace rows;

// Replaces the impulses in `starts` by the changes of velocity that they make. slope, curvature: those of each body.
void FindChanges(const BodyStore& store, const Indices& bodies, int count, WarmStart* starts, Lanes& slope,
                 Lanes& curvature) {
    Rows<Lanes> start(bodies, [&](uint32_t body) { return starts[body].Row(); });
    const Rows<Lanes> velocity(bodies, [&](uint32_t body) { return store.states[body].VelocityRow(); });
    InverseMass<Lanes> mass;
    GatherMass<kLanes>(bodies, store.masses.data(), mass);
    const Vec3<Lanes> impulse = VectorAt<WarmStart::kImpulse>(start.at),
                      angularImpulse = VectorAt<WarmStart::kAngularImpulse>(start.at);
    const Vec3<Lanes> linear = impulse.cwiseProduct(mass.mass), angular = mass.inertia * angularImpulse;
    slope = Dot<Lanes>(impulse, velocity.First()) + Dot<Lanes>(angularImpulse, velocity.Second()) +
            start.at[WarmStart::kWork];
    curvature = Dot<Lanes>(impulse, linear) + Dot<Lanes>(angularImpulse, angular) + start.at[WarmStart::kSoftWork];
    SetVectorAt<WarmStart::kImpulse>(start.at, linear);
    SetVectorAt<WarmStart::kAngularImpulse>(start.at, angular);
    start.Write(count);
}

void AddChanges(BodyStore& store, const Indices& bodies, int count, const Lanes& scale, WarmStart* starts) {
    Rows<Lanes> start(bodies, [&](uint32_t body) { return starts[body].Row(); });
    Rows<Lanes> velocity(bodies, [&](uint32_t body) { return store.states[body].VelocityRow(); });
    // Where the scale is zero changes may not be finite.
    const auto acts = scale > Lanes(0.0f);
    for (int k = 0; k < 6; ++k)
        velocity.at[k] = Select(acts, Lanes(velocity.at[k] + start.at[k] * scale), velocity.at[k]);
    velocity.Write(count);
    start.at[WarmStart::kWork] = scale;
    start.Write(count);
}

}  // namespace

bool ScaleWarmStarts(BodyStore& store, std::span<const uint32_t> bodies, const uint32_t* islandOf, WarmStart* starts,
                     std::span<IslandWarmStart> islands) {
    // A scale this close to one counts as one: of the energy that the warm start takes away, the square of the rest is
    // left.
    constexpr double kNearlyOne = 0.999;
    std::ranges::fill(islands, IslandWarmStart{});
    const uint32_t* island = islandOf;
    VisitInLanes(bodies, [&](const Indices& index, int count) {
        Lanes slope, curvature;
        FindChanges(store, index, count, starts, slope, curvature);
        for (int k = 0; k < count; ++k, ++island) {
            islands[*island].slope += double{slope[k]};
            islands[*island].curvature += double{curvature[k]};
        }
    });
    bool scales = false;
    for (IslandWarmStart& sums : islands) {
        // Zero also for what is not a number. Where nothing would change, and in what is no island, no scale is needed.
        const double best = sums.curvature > 0 ? -sums.slope / sums.curvature : 0;
        sums.scale = best > kNearlyOne || sums.curvature == 0 ? 1.0f : static_cast<float>(std::max(best, 0.0));
        scales |= sums.scale < 1;
    }
    island = islandOf;
    VisitInLanes(bodies, [&](const Indices& index, int count) {
        Lanes scale(1.0f);
        if (scales)
            for (int k = 0; k < count; ++k) scale.Set(k, islands[island[k]].scale);
        island += count;
        AddChanges(store, index, count, scale, starts);
    });
    return scales;
}

}  // namespace fulcrum
