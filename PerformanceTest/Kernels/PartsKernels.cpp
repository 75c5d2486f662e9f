// Nanoseconds per row of the row part's kernels, one constraint at a time and in lanes. Single-threaded.
// "rows_per_second" counts constraints, so its inverse is the time per row whatever the number of lanes.
#include <Fulcrum/Constraints/Parts/AxisPart.h>
#include <Fulcrum/Constraints/Parts/RowPart.h>
#include <Fulcrum/Constraints/Parts/SpringSoftness.h>

#include <benchmark/benchmark.h>

#include <random>
#include <vector>

namespace fulcrum {
namespace {

constexpr int kRows = 1024;  // fits the second-level cache, as one color's share of a thread does
constexpr int kBodies = 2 * kRows;

template <class Real>
constexpr int kCount = sizeof(Real) / sizeof(float);

template <class Real>
struct Constraint {
    RowPart<Real> part;
    int bodies1[kCount<Real>], bodies2[kCount<Real>];
};

struct World {
    std::vector<BodyState> states = std::vector<BodyState>(kBodies);
    std::vector<BodyMass> masses = std::vector<BodyMass>(kBodies);
};

template <int N>
void Gather(World& world, const int (&bodies)[N], Twist<Wide<N>>& velocity) {
    const float* rows[N];
    Wide<N> wide[8];
    for (int i = 0; i < N; ++i) rows[i] = world.states[bodies[i]].VelocityRow();
    GatherRows<N>(rows, wide);
    velocity.linear = Vec3<Wide<N>>(wide[0], wide[1], wide[2]);
    velocity.angular = Vec3<Wide<N>>(wide[3], wide[4], wide[5]);
}
void Gather(World& world, const int (&bodies)[1], Twist<float>& velocity) {
    const float* row = world.states[bodies[0]].VelocityRow();
    velocity.linear = Vector3(row[0], row[1], row[2]);
    velocity.angular = Vector3(row[3], row[4], row[5]);
}
template <int N>
void GatherMass(World& world, const int (&bodies)[N], InverseMass<Wide<N>>& mass) {
    const float* rows[N];
    Wide<N> wide[8];
    for (int i = 0; i < N; ++i) rows[i] = world.masses[bodies[i]].Row();
    GatherRows<N>(rows, wide);
    mass.inertia = {wide[0], wide[1], wide[2], wide[3], wide[4], wide[5]};
    mass.mass = Vec3<Wide<N>>(wide[6], wide[6], wide[6]);
}
void GatherMass(World& world, const int (&bodies)[1], InverseMass<float>& mass) {
    const float* m = world.masses[bodies[0]].Row();
    mass.inertia = {m[0], m[1], m[2], m[3], m[4], m[5]};
    mass.mass = Vector3::Constant(m[6]);
}
template <int N>
void Scatter(World& world, const int (&bodies)[N], const Twist<Wide<N>>& velocity) {
    float* rows[N];
    for (int i = 0; i < N; ++i) rows[i] = world.states[bodies[i]].VelocityRow();
    const Wide<N> wide[8] = {velocity.linear.x(),  velocity.linear.y(),  velocity.linear.z(), velocity.angular.x(),
                             velocity.angular.y(), velocity.angular.z(), Wide<N>(0.0f),       Wide<N>(0.0f)};
    ScatterRows<N>(rows, wide, N);
}
void Scatter(World& world, const int (&bodies)[1], const Twist<float>& velocity) {
    float* row = world.states[bodies[0]].VelocityRow();
    for (int k = 0; k < 3; ++k) row[k] = velocity.linear[k];
    for (int k = 0; k < 3; ++k) row[3 + k] = velocity.angular[k];
}

template <class Real>
Vec3<Real> RandomVector(std::mt19937& random) {
    const auto number = [&] {
        Real lanes(0.0f);
        for (int i = 0; i < kCount<Real>; ++i)
            detail::SetLaneOf(lanes, i, static_cast<float>(random()) / 2147483648.0f - 1.0f);
        return lanes;
    };
    const Real x = number(), y = number(), z = number();
    return Vec3<Real>(x, y, z);
}

// Rows between bodies 2 i and 2 i + 1, so that no two touch the same body.
template <class Real>
std::vector<Constraint<Real>> MakeConstraints(World& world, std::mt19937& random) {
    for (BodyMass& mass : world.masses) mass = {{6.0f, 7.0f, 5.0f, 0.1f, 0.2f, 0.3f}, 1.0f, 0.0f};
    for (BodyState& state : world.states)
        for (int k = 0; k < 6; ++k) state.VelocityRow()[k] = static_cast<float>(random()) / 2147483648.0f - 1.0f;
    std::vector<Constraint<Real>> constraints(kRows / kCount<Real>);
    int body = 0;
    for (auto& constraint : constraints) {
        for (int i = 0; i < kCount<Real>; ++i) {
            constraint.bodies1[i] = body++;
            constraint.bodies2[i] = body++;
        }
        InverseMass<Real> mass1, mass2;
        GatherMass(world, constraint.bodies1, mass1);
        GatherMass(world, constraint.bodies2, mass2);
        const Vec3<Real> direction = RandomVector<Real>(random), r1 = RandomVector<Real>(random);
        const Vec3<Real> axis = direction * (Real(1.0f) / Sqrt(Dot<Real>(direction, direction)));
        constraint.part.SetJacobian(AxisJacobian<Real>({r1, RandomVector<Real>(random), axis}));
        constraint.part.CalculateProperties(mass1, mass2);
        constraint.part.SetBias(Real(0.1f));
    }
    return constraints;
}

void CountRows(benchmark::State& state) {
    state.counters["rows_per_second"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * kRows, benchmark::Counter::kIsRate);
    state.counters["s_per_row"] = benchmark::Counter(static_cast<double>(state.iterations()) * kRows,
                                                     benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// Limits that change sides every pass, so that every solve has an impulse to apply.
template <class Real>
struct Limits {
    Real low = Real(0.1f), high = Real(0.3f);
    void Flip() {
        const Real before = low;
        low = -high;
        high = -before;
    }
};

// Everything that a solver does for a row: bodies gathered, one velocity iteration, bodies scattered.
template <class Real>
void AxisSolveVelocity(benchmark::State& state) {
    World world;
    std::mt19937 random(1);
    auto constraints = MakeConstraints<Real>(world, random);
    Limits<Real> limits;
    for (auto _ : state) {
        for (auto& constraint : constraints) {
            Twist<Real> velocity1, velocity2;
            Gather(world, constraint.bodies1, velocity1);
            Gather(world, constraint.bodies2, velocity2);
            constraint.part.SolveVelocity(velocity1, velocity2, limits.low, limits.high);
            Scatter(world, constraint.bodies1, velocity1);
            Scatter(world, constraint.bodies2, velocity2);
        }
        limits.Flip();
        benchmark::ClobberMemory();
    }
    CountRows(state);
}

// The row alone, as the second to fourth point of a contact pays it: the two bodies stay in registers or on the stack.
template <class Real>
void AxisSolveVelocityGathered(benchmark::State& state) {
    World world;
    std::mt19937 random(1);
    auto constraints = MakeConstraints<Real>(world, random);
    Twist<Real> velocity1, velocity2;
    Gather(world, constraints[0].bodies1, velocity1);
    Gather(world, constraints[0].bodies2, velocity2);
    Limits<Real> limits;
    for (auto _ : state) {
        for (auto& constraint : constraints)
            constraint.part.SolveVelocity(velocity1, velocity2, limits.low, limits.high);
        limits.Flip();
        benchmark::ClobberMemory();
    }
    CountRows(state);
}

template <class Real>
void AxisSetUpSpring(benchmark::State& state) {
    World world;
    std::mt19937 random(1);
    auto constraints = MakeConstraints<Real>(world, random);
    InverseMass<Real> mass1, mass2;
    GatherMass(world, constraints[0].bodies1, mass1);
    GatherMass(world, constraints[0].bodies2, mass2);
    const SpringForm form = state.range(0) != 0 ? SpringForm::Exact : SpringForm::Implicit;
    const SpringConstants<Real> spring = FrequencyConstants(Real(2.0f), Real(0.1f), form);
    const AxisFrame<Real> frame{RandomVector<Real>(random), RandomVector<Real>(random),
                                constraints[0].part.GetJacobian().a.linear};
    for (auto _ : state) {
        for (auto& constraint : constraints) {
            RowPart<Real>& part = constraint.part;
            part.SetJacobian(AxisJacobian(frame));
            part.CalculateProperties(mass1, mass2);
            const SpringSoftness<Real> soft =
                SpringSoftnessOf(Real(1.0f / 240.0f), Real(Real(1.0f) / part.GetEffectiveMass()), spring);
            part.SetBias(soft.errorRate * Real(0.1f), soft.softness);
        }
        benchmark::ClobberMemory();
    }
    CountRows(state);
}

BENCHMARK(AxisSolveVelocity<float>)->Name("Axis/SolveVelocity/scalar");
BENCHMARK(AxisSolveVelocity<Wide<4>>)->Name("Axis/SolveVelocity/4_lanes");
BENCHMARK(AxisSolveVelocity<Wide<8>>)->Name("Axis/SolveVelocity/8_lanes");
BENCHMARK(AxisSolveVelocityGathered<float>)->Name("Axis/SolveVelocity/gathered/scalar");
BENCHMARK(AxisSolveVelocityGathered<Wide<4>>)->Name("Axis/SolveVelocity/gathered/4_lanes");
BENCHMARK(AxisSolveVelocityGathered<Wide<8>>)->Name("Axis/SolveVelocity/gathered/8_lanes");
BENCHMARK(AxisSetUpSpring<float>)->Name("Axis/SetUpSpring/exact/scalar")->Arg(1);
BENCHMARK(AxisSetUpSpring<Wide<8>>)->Name("Axis/SetUpSpring/exact/8_lanes")->Arg(1);
BENCHMARK(AxisSetUpSpring<Wide<8>>)->Name("Axis/SetUpSpring/implicit/8_lanes")->Arg(0);

}  // namespace
}  // namespace fulcrum
