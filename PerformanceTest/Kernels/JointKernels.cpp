// Nanoseconds per joint of the joint kernels: each kind with locks alone and with rows; setup once a step (prepare),
// and in every substep one velocity iteration (velocity) and one position iteration that also adds the warm start of
// the next substep (correct). Single-threaded; 1024 joints, which fit the second-level cache, between 2048 bodies whose
// indices are anywhere. "rows" is the mean number of rows of a joint. Ball joints, which are points with nothing on,
// have kernels of their own, and faster ones between round bodies.
#include <Fulcrum/UnitTests/Constraints/Joints/RandomBalls.h>

#include <benchmark/benchmark.h>

#include <string>

namespace fulcrum {
namespace {

using testing::JointCase;
using testing::RandomJoints;

constexpr uint32_t kJoints = 1024;

// Joints of one kind in batches of N, prepared.
template <int N>
class PreparedJoints {
public:
    explicit PreparedJoints(const JointCase& how)
        : joints_(std::span(&how, 1), kJoints, 1, {}),
          batches_(joints_.Batches<N>(rows_)),
          settings_(testing::DefaultJointSettings()) {
        settings_.elapsed = settings_.substepDt;
        Prepare();
    }

    void Prepare() {
        JointFindings findings;
        for (JointBatch<N>& batch : batches_)
            PrepareJoints(batch, joints_.records.data(), joints_.typePointers.data(), joints_.Bodies(), settings_,
                          findings);
        benchmark::DoNotOptimize(findings);
    }
    void SolveVelocities() {
        for (JointBatch<N>& batch : batches_) SolveJointVelocities(batch, joints_.states.data(), settings_);
    }
    void Correct() {
        for (JointBatch<N>& batch : batches_) CorrectJoints(batch, joints_.Bodies(), starts_.data(), settings_);
    }
    double RowsPerJoint() const {
        double count = 0;
        for (const JointBatch<N>& batch : batches_)
            for (uint32_t i = 0; i < batch.rowCount; ++i)
                for (int lane = 0; lane < batch.count; ++lane) count += batch.rows[i].slot[lane] != 0xFF;
        return count / kJoints;
    }

private:
    RandomJoints joints_;
    std::vector<JointRows<N>> rows_;
    std::vector<JointBatch<N>> batches_;
    std::vector<WarmStart> starts_{joints_.states.size()};
    JointSolveSettings settings_;
};

template <int N>
class PreparedBalls {
public:
    explicit PreparedBalls(bool round)
        : joints_(testing::RandomBalls(kJoints, 1, {round, {}})), settings_(testing::DefaultJointSettings()) {
        std::vector<JointRows<N>> none;
        for (const JointBatch<N>& batch : joints_.Batches<N>(none)) batches_.push_back(testing::BallsOf(batch, round));
        settings_.elapsed = settings_.substepDt;
        Prepare();
    }

    void Prepare() {
        JointFindings findings;
        for (BallBatch<N>& batch : batches_)
            PrepareJoints(batch, joints_.records.data(), joints_.Bodies(), settings_, findings);
        benchmark::DoNotOptimize(findings);
    }
    void SolveVelocities() {
        for (BallBatch<N>& batch : batches_) SolveJointVelocities(batch, joints_.states.data(), settings_);
    }
    void Correct() {
        for (BallBatch<N>& batch : batches_) CorrectJoints(batch, joints_.Bodies(), starts_.data(), settings_);
    }
    double RowsPerJoint() const { return 0; }

private:
    RandomJoints joints_;
    std::vector<BallBatch<N>> batches_;
    std::vector<WarmStart> starts_{joints_.states.size()};
    JointSolveSettings settings_;
};

template <class Joints, class How>
void Run(benchmark::State& state, const How& how, void (Joints::*verb)()) {
    Joints joints(how);
    for (auto _ : state) {
        (joints.*verb)();
        benchmark::ClobberMemory();
    }
    state.counters["s_per_joint"] = benchmark::Counter(static_cast<double>(state.iterations()) * kJoints,
                                                       benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.counters["rows"] = joints.RowsPerJoint();
}

template <class Joints, class How>
void Register(const std::string& kind, const How& how, const std::string& lanes) {
    const auto add = [&](const char* name, void (Joints::*verb)()) {
        const std::string full = "Joint/" + kind + "/" + name + "/" + lanes;
        benchmark::RegisterBenchmark(full.c_str(),
                                     [&how, verb](benchmark::State& state) { Run<Joints>(state, how, verb); });
    };
    add("prepare", &Joints::Prepare);
    add("velocity", &Joints::SolveVelocities);
    add("correct", &Joints::Correct);
}

template <template <int> class Joints, class How>
void RegisterLanes(const std::string& kind, const How& how) {
    Register<Joints<1>>(kind, how, "scalar");
    if constexpr (kLanes > 1) Register<Joints<kLanes>>(kind, how, std::to_string(kLanes) + "_lanes");
}

[[maybe_unused]] const bool kRegistered = [] {
    static constexpr bool kRound = true, kAny = false;
    RegisterLanes<PreparedBalls>("ball/round", kRound);
    RegisterLanes<PreparedBalls>("ball/any", kAny);
    for (const JointCase& how : testing::AllJointCases())
        RegisterLanes<PreparedJoints>(std::string(how.kind) + "/" + how.state, how);
    return true;
}();

}  // namespace
}  // namespace fulcrum
