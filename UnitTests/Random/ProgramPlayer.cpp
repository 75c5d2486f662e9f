#include <Fulcrum/Physics/Snapshots/Snapshots.h>
#include <Fulcrum/UnitTests/Random/Program.h>
#include <Fulcrum/UnitTests/Random/Watch.h>
#include <Fulcrum/UnitTests/Support/Cases.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <sstream>

namespace fulcrum::testing {

namespace {

// CPU time, s, that a call may take in one world of a few dozen bodies. Of the process: other programs on the machine
// do not count.
constexpr double kLongestCall = kIsSanitized ? 20 : 1;

double Seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

bool IsStep(const RandomCall& call) { return std::string_view(call.kind->name) == "Step"; }

// A bound of what a step may add to twice the kinetic energy, J: gravity, pushes out of overlaps, kinematic bodies and
// those that a contact listener makes as heavy, belts. Each is a speed that a body may gain: from v to v + g, and (v +
// g)^2 / 2 <= v^2 + g^2. Generous, and still far below the effect of a sign error or of an impulse that is applied
// twice.
double EnergyAllowance(const Twin& twin) {
    const SystemSettings& settings = twin.system->Settings();
    const BodyInterface& bodies = twin.system->Bodies();
    double fastest = 0;
    twin.system->VisitBodies([&](BodyId id) {
        if (bodies.GetMotionType(id) == MotionType::Dynamic && !twin.scalesMasses) return;
        const double size = double{bodies.GetShape(id)->OuterRadius()};  // of a plane that turns: endless
        fastest = std::max(fastest, double{Length(bodies.GetLinearVelocity(id))} +
                                        size * double{Length(bodies.GetAngularVelocity(id))});
    });
    double sum = 0;
    twin.system->VisitBodies([&](BodyId id) {
        const double gravity = double{Length(bodies.GetGravity(id))};
        const double gained = gravity * 0.3 + 2 * double{settings.contactPushSpeed} + 2 * fastest + 2;
        const double speed = double{Length(bodies.GetLinearVelocity(id))};
        sum += double{bodies.GetMass(id)} * (gained * gained + speed * gravity * 0.2);
    });
    return sum;
}

// Whether a body is pushed out of another in opposite directions. At two points a short way apart that turns it, as
// fast as the pushes are over their distance: a compound in a slab half as thick, pushed out on both sides. What that
// adds has no bound by speeds. Checked after the step, in which one of the two may have separated.
bool IsSqueezed(const Twin& twin) {
    struct Push {
        BodyId bodyA, bodyB;
        Vector3 normal;
        bool isDeep;
    };
    std::vector<Push> pushes;
    twin.system->VisitContacts([&](const ContactView& contact) {
        float impulse = 0, separation = 0;
        for (const ContactView::Point& point : contact.points) {
            impulse += point.impulse;
            separation = std::min(separation, point.separation);
        }
        if (!(impulse > 0)) return;
        const auto radius = [&](BodyId id) { return twin.system->Bodies().GetShape(id)->InnerRadius(); };
        pushes.push_back({contact.bodyA, contact.bodyB, contact.normal,
                          -separation > 0.25f * std::min(radius(contact.bodyA), radius(contact.bodyB))});
    });
    for (const Push& one : pushes)
        for (const Push& other : pushes)
            if (one.isDeep && one.bodyA == other.bodyA && one.bodyB == other.bodyB &&
                Dot(one.normal, other.normal) < -0.5f)
                return true;
    return false;
}

// Whether a kinematic body may push one that is guided by locked axes, or by something else that is immovable: a floor
// under it. An inclined face that moves at v drives what it touches along a guide at v over the sine of the angle
// between them, a wedge: that has no bound by speeds either.
bool IsWedged(const Twin& twin) {
    const BodyInterface& bodies = twin.system->Bodies();
    const auto isGuided = [&](BodyId id) {
        return std::find(twin.guided.begin(), twin.guided.end(), id) != twin.guided.end();
    };
    std::vector<std::pair<BodyId, BodyId>> held;  // bodies that touch an immovable one, and which
    bool found = false;
    twin.system->VisitContacts([&](const ContactView& contact) {
        const bool isA = bodies.GetMotionType(contact.bodyA) == MotionType::Dynamic,
                   isB = bodies.GetMotionType(contact.bodyB) == MotionType::Dynamic;
        if (isA != isB) held.emplace_back(isA ? contact.bodyA : contact.bodyB, isA ? contact.bodyB : contact.bodyA);
        const bool isGuidedA = isGuided(contact.bodyA), isGuidedB = isGuided(contact.bodyB);
        if (isGuidedA == isGuidedB) return;
        const BodyId other = isGuidedA ? contact.bodyB : contact.bodyA;
        const bool isDriven = bodies.GetMotionType(other) == MotionType::Kinematic;
        found |= isDriven || twin.scalesMasses;
    });
    for (const auto& [body, driver] : held)
        for (const auto& [same, other] : held)
            found |= body == same && driver != other && bodies.GetMotionType(driver) == MotionType::Kinematic;
    return found;
}

class Game {
public:
    Game(const RandomProgram& program, JobSystem* two, JobSystem* four) : program_(program) {
        JobSystem* const none = nullptr;
        for (JobSystem* const jobs : {none, two, four, none, none}) twins_.emplace_back(SystemSettings{}, jobs);
    }

    std::optional<ProgramFailure> Play() {
        state_ = HashOfState(twins_[0]);
        for (size_t i = 0; i < program_.calls.size(); ++i) {
            Watch::Note(program_.seed, i, program_.calls[i].kind->name);
            const std::string what = PlayCall(program_.calls[i]);
            if (std::getenv("FULCRUM_RANDOM_TRACE")) Trace(i, program_.calls[i]);
            if (!what.empty()) return ProgramFailure{i, what};
        }
        return std::nullopt;
    }

private:
    // Prints all bodies, for debugging.
    void Trace(size_t number, const RandomCall& call) {
        std::printf("%zu %s\n", number, call.kind->name);
        const BodyInterface& bodies = twins_[0].system->Bodies();
        twins_[0].system->VisitBodies([&](BodyId id) {
            const Position at = bodies.GetPose(id).position;
            const Vector3 v = bodies.GetLinearVelocity(id), w = bodies.GetAngularVelocity(id);
            std::printf(
                "    body %u %s motion %d mass %g at %g %g %g v %g %g %g w %g %g %g locks %u continuous %d awake %d\n",
                id.index, ShapeTypeName(bodies.GetShape(id)->Type()), static_cast<int>(bodies.GetMotionType(id)),
                double{bodies.GetMass(id)}, at.x(), at.y(), at.z(), double{v.x()}, double{v.y()}, double{v.z()},
                double{w.x()}, double{w.y()}, double{w.z()}, static_cast<unsigned>(bodies.GetLockedAxes(id)),
                static_cast<int>(bodies.GetContinuous(id)), bodies.IsAwake(id));
        });
        twins_[0].system->VisitContacts([&](const ContactView& contact) {
            const Vector3& n = contact.normal;
            std::printf("    contact %u.%u %u.%u normal %g %g %g", contact.bodyA.index, contact.childA,
                        contact.bodyB.index, contact.childB, double{n.x()}, double{n.y()}, double{n.z()});
            for (const ContactView::Point& point : contact.points)
                std::printf(", at %g %g %g apart %g impulse %g", point.position.x(), point.position.y(),
                            point.position.z(), double{point.separation}, double{point.impulse});
            std::printf("\n");
        });
    }

    static constexpr size_t kWithoutRefused = 3, kGoesBack = 4;

    Outcome PlayIn(Twin& twin, const RandomCall& call) {
        Outcome outcome;
        Values values(call.seed, program_.style);
        call.kind->play(twin, values, call.targets, outcome);
        return outcome;
    }

    // Plays the call, takes it back by a snapshot, and plays it again.
    Outcome PlayTwice(Twin& twin, const RandomCall& call) {
        const bool changesListener = std::string_view(call.kind->name) == "SetContactListener";
        // Always: a later snapshot may name the shape of a body that is removed by then, until the next step.
        NoteSources(*twin.system);
        // Compounds with custom children cannot be saved.
        if (changesListener || !twin.system->SaveSnapshot(saved_)) return PlayIn(twin, call);
        const auto bodies = twin.bodies;
        const auto joints = twin.joints;
        const auto ragdolls = twin.ragdolls;
        PlayIn(twin, call);
        Outcome outcome;
        const Status restored = twin.system->RestoreSnapshot(saved_, {.shapes = shapes_, .groupFilters = filters_});
        if (!restored) outcome.failure = "a snapshot was refused: " + restored.GetError().message;
        else if (!twin.system->SaveSnapshot(again_) || again_ != saved_)
            outcome.failure = "a snapshot did not restore what was saved";
        if (!outcome.failure.empty()) return outcome;
        twin.bodies = bodies;
        twin.joints = joints;
        twin.ragdolls = ragdolls;
        return PlayIn(twin, call);
    }

    // Shapes and filters that snapshots may name.
    void NoteSources(const PhysicsSystem& system) {
        const auto note = [](auto& list, const auto& item) {
            if (item && std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
        };
        system.VisitBodies([&](BodyId id) {
            note(shapes_, system.Bodies().GetShape(id));
            note(filters_, system.Bodies().GetGroup(id).filter);
        });
    }

    std::string PlayCall(const RandomCall& call) {
        const double before = Seconds(), energy = KineticEnergy(twins_[0]),
                     allowance = IsStep(call) ? EnergyAllowance(twins_[0]) : 0;
        wasWedged_ = IsStep(call) && IsWedged(twins_[0]);
        posesBefore_ = twins_[0].system->HashPoses();
        const Outcome first = PlayIn(twins_[0], call);
        const double took = Seconds() - before;
        if (!first.failure.empty()) return first.failure;
        if (std::string wrong = WrongIn(twins_[0]); !wrong.empty()) return wrong;
        const uint64_t state = HashOfState(twins_[0]);
        if (first.isRefused && state != state_) return "a call that was refused has changed something";
        if (std::string wrong = PlayInOthers(call, first, state); !wrong.empty()) return wrong;
        state_ = state;
        if (took > kLongestCall) return "a call took " + std::to_string(took) + " s";
        return CheckEnergy(call, energy, allowance);
    }

    std::string PlayInOthers(const RandomCall& call, const Outcome& first, uint64_t state) {
        constexpr const char* kNames[] = {"one thread", "two threads", "four threads", "no calls that are refused",
                                          "snapshots"};
        const uint64_t whole = twins_[0].system->HashState();
        for (size_t i = 1; i < twins_.size(); ++i) {
            if (i == kWithoutRefused && first.isRefused) continue;
            const Outcome outcome = i == kGoesBack ? PlayTwice(twins_[i], call) : PlayIn(twins_[i], call);
            if (!outcome.failure.empty()) return outcome.failure;
            if (outcome.answer.Value() != first.answer.Value()) return std::string("another answer with ") + kNames[i];
            if (twins_[i].system->HashPoses() != twins_[0].system->HashPoses())
                return std::string("other poses with ") + kNames[i];
            if (HashOfState(twins_[i]) != state) return std::string("another state with ") + kNames[i];
            if (twins_[i].system->HashState() != whole)
                return std::string("another state that cannot be read with ") + kNames[i] + FirstDifference(twins_[i]);
        }
        return {};
    }

    // Between the snapshots of the first world and of another one.
    std::string FirstDifference(const Twin& other) {
        if (!twins_[0].system->SaveSnapshot(saved_) || !other.system->SaveSnapshot(again_)) return {};
        const Result<SnapshotParts> first = CheckSnapshot(saved_), second = CheckSnapshot(again_);
        if (!first || !second) return {};
        const SnapshotParts &a = first.Value(), &b = second.Value();
        for (size_t i = 0, at = 0; i < a.header.blocks && i < b.header.blocks; at += a.BlockAt(i++).size) {
            const SnapshotBlock one = a.BlockAt(i), two = b.BlockAt(i);
            const size_t size = std::min(one.size, two.size);
            const auto differs = std::mismatch(&a.data[at], &a.data[at] + size, &b.data[at]).first - &a.data[at];
            if (one.key != two.key || one.size != two.size || static_cast<size_t>(differs) != size)
                return ": section " + std::to_string(one.key >> 24) + ", block " + std::to_string(one.key & 0xffffff) +
                       ", sizes " + std::to_string(one.size) + " and " + std::to_string(two.size) + ", from byte " +
                       std::to_string(differs);
        }
        return {};
    }

    // Of programs without extremes and joints, whose springs hold any energy, in steps in which no force is pending.
    std::string CheckEnergy(const RandomCall& call, double before, double allowance) {
        const std::string_view name = call.kind->name;
        if (name.starts_with("AddForce") || name == "AddTorque" || name == "AddSteadyForce" || name == "ApplyFields")
            isPushed_ = true;
        if (!IsStep(call) || program_.style.oddChance > 0 || program_.style.joints) return {};
        if (twins_[0].system->HashPoses() == posesBefore_)
            return {};  // a step of no length, after which forces wait still
        const bool isPushed = isPushed_;
        isPushed_ = false;
        const double after = KineticEnergy(twins_[0]);
        if (isPushed || after <= 2 * before + allowance || IsSqueezed(twins_[0]) || wasWedged_ || IsWedged(twins_[0]))
            return {};
        std::ostringstream text;
        text << "kinetic energy rose from " << before << " to " << after << " J in a step, which may add " << allowance;
        return text.str();
    }

    const RandomProgram& program_;
    std::vector<Twin> twins_;
    std::vector<std::byte> saved_, again_;
    std::vector<ShapePtr> shapes_;
    std::vector<std::shared_ptr<const GroupFilter>> filters_;
    uint64_t state_ = 0;
    uint64_t posesBefore_ = 0;
    bool isPushed_ = false;
    bool wasWedged_ = false;  // before the step
};

}  // namespace

std::optional<ProgramFailure> ProgramPlayer::Play(const RandomProgram& program) {
    return Game(program, &two_, &four_).Play();
}

}  // namespace fulcrum::testing
