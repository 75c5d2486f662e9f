// Spoils one number, id, enumerator or shape of a call's arguments at a time: visits all of them, down to the members
// of settings, and gives them values that are not a number, infinite, zero, negative, huge, stale, foreign, null or out
// of range. What must be refused follows from the type, and from the ranges in the comments of the members.
#pragma once

#include <Fulcrum/Physics/Recording/CallCodec.h>
#include <Fulcrum/UnitTests/Support/PublicHeaders.h>

#include <map>
#include <string>

namespace fulcrum::testing {

// Whether the range in a comment, such as `m, > 0` or `1..255 per substep`, excludes a value.
bool IsExcluded(const std::string& comment, double value);

std::string NumberText(double value);

// The comments of a structure's members, by name; none of structures that are not settings.
struct SettingsHeader {
    const char* file = nullptr;
    const char* type = nullptr;
};
template <class T>
inline constexpr SettingsHeader kSettingsHeader{nullptr, nullptr};
using MemberComments = std::map<std::string, std::string>;
const MemberComments& CommentsOf(const SettingsHeader& header);

enum class Verdict : uint8_t {
    MustBeRefused,
    MayBeRefused,  // valid, or not, as it fits the other arguments: if it is taken, the world stays finite
};

struct Spoiled {
    std::string path, value;
    Verdict verdict = Verdict::MustBeRefused;
};

// Ids that nothing has.
struct BadIds {
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;
};

class Spoiler {
public:
    // which: the number of the spoiled value, from 0 on; Done() is empty once there are no more.
    Spoiler(size_t which, const BadIds& ids) : left_(which), ids_(ids) {}

    const std::optional<Spoiled>& Done() const { return done_; }

    // comment: with its range, as beside a member.
    template <class T>
    void Argument(const std::string& name, T& value, const std::string& comment = {}) {
        path_ = name;
        comment_ = comment;
        Visit(value);
    }

    // ---- An archive of SettingsFields.h

    template <class T>
    void Field(const char* name, T& value) {
        const std::string path = path_, comment = comment_;
        path_ += std::string(".") + name;
        comment_.clear();
        for (const MemberComments* const comments : comments_)
            if (const auto found = comments->find(name); found != comments->end()) comment_ = found->second;
        Visit(value);
        path_ = path;
        comment_ = comment;
    }
    template <class E, class Names>
    void Choice(const char* name, E& value, const Names& names) {
        const std::string path = path_;
        path_ += std::string(".") + name;
        VisitEnumerator(value, names.size());
        path_ = path;
    }

private:
    template <class T>
    void Visit(T& value) {
        if constexpr (std::is_floating_point_v<T>) VisitNumber(value);
        else if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, uint64_t>) return;  // any value is good
        else if constexpr (std::is_integral_v<T>) VisitInteger(value);
        else if constexpr (std::is_same_v<T, LockedAxes>) VisitEnumerator(value, 64);
        else if constexpr (std::is_same_v<T, SensorSees>) VisitEnumerator(value, 32);
        else if constexpr (std::is_same_v<T, JointAxis>) VisitEnumerator(value, 6);
        else if constexpr (std::is_same_v<T, MotionType> || std::is_same_v<T, ContinuousCollision>)
            VisitEnumerator(value, 3);
        else if constexpr (std::is_enum_v<T>) VisitEnumerator(value, 2);  // MassUpdate
        else if constexpr (std::is_same_v<T, Vector3> || std::is_same_v<T, Position>) VisitVector(value);
        else if constexpr (std::is_same_v<T, Quaternion>) VisitRotation(value);
        else if constexpr (std::is_same_v<T, SymmetricMatrix3>) VisitMatrix(value);
        else if constexpr (std::is_same_v<T, MassOverride>) DescribeIn(value);
        else if constexpr (std::is_same_v<T, BodyId>) VisitId(value, ids_.bodies);
        else if constexpr (std::is_same_v<T, JointId>) VisitId(value, ids_.joints);
        else if constexpr (std::is_same_v<T, ChildId>)
            VisitId(value, {ChildId{}, ChildId{value.index, value.generation + 1}, ChildId{77, 0}});
        else if constexpr (std::is_same_v<T, ShapePtr> || std::is_same_v<T, std::shared_ptr<const Path>>)
            Try("null", Verdict::MustBeRefused, [&] { value = nullptr; });
        else if constexpr (std::is_same_v<T, std::shared_ptr<const GroupFilter>> ||
                           std::is_same_v<T, const ContactListener*> || std::is_same_v<T, SnapshotSources>)
            return;  // null means none
        else VisitStructure(value);
    }

    template <class T>
    void VisitStructure(T& value) {
        DescribeIn(value);
    }
    void VisitStructure(BodyBatch::Joint& joint) {
        std::visit([&](auto& settings) { Visit(settings); }, joint);
    }
    template <class T>
    void VisitStructure(std::optional<T>& value) {
        if (value) Visit(*value);
    }
    template <class T, size_t kSize>
    void VisitStructure(std::array<T, kSize>& values) {
        Visit(values.back());
    }
    template <class T>
    void VisitStructure(std::vector<T>& values) {
        if constexpr (std::is_same_v<T, std::byte>) {
            Try("nothing", Verdict::MustBeRefused, [&] { values.clear(); });
            Try("half of it", Verdict::MustBeRefused, [&] { values.resize(values.size() / 2); });
            Try("a bit flipped", Verdict::MustBeRefused, [&] { values[values.size() / 3] ^= std::byte{4}; });
        } else {
            if (values.empty()) return;
            const std::string path = path_;
            path_ += "[" + std::to_string(values.size() - 1) + "]";
            Visit(values.back());
            path_ = path;
        }
    }
    template <class T>
    void DescribeIn(T& value) {
        std::array comments = {&CommentsOf(kSettingsHeader<T>), &CommentsOf({})};
        if constexpr (std::is_base_of_v<JointSettings, T>)
            comments[1] = &CommentsOf({"Physics/JointSettings.h", "JointSettings"});
        comments.swap(comments_);
        DescribeWhole(*this, value);
        comments.swap(comments_);
    }

    template <class T>
    void VisitNumber(T& value) {
        constexpr double kHuge = std::is_same_v<T, float> ? 3e38 : 1e300;
        const double infinite = std::numeric_limits<double>::infinity();
        Try("NaN", Verdict::MustBeRefused, [&] { value = std::numeric_limits<T>::quiet_NaN(); });
        const bool mayBeInfinite = comment_.find("infini") != std::string::npos;
        for (const double bad : {infinite, -infinite, -1.0, 0.0, kHuge, -kHuge, 1e-40}) {
            if (Skips()) continue;
            const bool isInfinite = std::abs(bad) == infinite;
            bool mustBe = IsExcluded(comment_, bad) || (isInfinite && !mayBeInfinite);
            // No float has a place like that; but a region may have any bounds.
            mustBe |= std::is_same_v<T, double> && std::abs(bad) == kHuge && path_.find("region") == std::string::npos;
            if (isInfinite && mayBeInfinite) mustBe = false;
            Try(NumberText(bad), mustBe ? Verdict::MustBeRefused : Verdict::MayBeRefused,
                [&] { value = static_cast<T>(bad); });
        }
    }
    template <class T>
    void VisitInteger(T& value) {
        for (const double bad : {-1.0, 0.0, 32.0, 255.0, 256.0, 2147483647.0, -2147483648.0}) {
            if (bad < static_cast<double>(std::numeric_limits<T>::min()) ||
                bad > static_cast<double>(std::numeric_limits<T>::max()))
                continue;
            if (Skips()) continue;
            Try(NumberText(bad), IsExcluded(comment_, bad) ? Verdict::MustBeRefused : Verdict::MayBeRefused,
                [&] { value = static_cast<T>(bad); });
        }
    }
    template <class E>
    void VisitEnumerator(E& value, size_t count) {
        for (const size_t bad : {count, size_t{200}, size_t{255}})
            Try("enumerator " + std::to_string(bad), Verdict::MustBeRefused, [&] { value = static_cast<E>(bad); });
    }
    template <class T>
    void VisitVector(T& value) {
        for (int k = 0; k < 3; ++k) {
            const std::string path = path_;
            path_ += "[" + std::to_string(k) + "]";
            VisitNumber(value[k]);
            path_ = path;
        }
    }
    void VisitRotation(Quaternion& q) {
        VisitNumbers({&q.x, &q.y, &q.z, &q.w});
        Try("twice as long", Verdict::MustBeRefused, [&] { q = {0, 0, 0, 2}; });
        Try("zero", Verdict::MustBeRefused, [&] { q = {0, 0, 0, 0}; });
    }
    void VisitMatrix(SymmetricMatrix3& m) {
        VisitNumbers({&m.xx, &m.yy, &m.zz, &m.xy, &m.xz, &m.yz});
        Try("indefinite", Verdict::MustBeRefused, [&] { m.xy = 10 * m.xx; });
    }
    void VisitNumbers(std::initializer_list<float*> numbers) {
        for (float* const number : numbers) VisitNumber(*number);
    }
    template <class Id>
    void VisitId(Id& id, const std::vector<Id>& bad) {
        for (const Id one : bad)
            Try("id " + std::to_string(one.index) + "/" + std::to_string(one.generation), Verdict::MustBeRefused,
                [&] { id = one; });
    }

    // Whether the next value is not the one: it is left out without a look at it.
    bool Skips() {
        if (left_ == 0 || left_ == kNone) return left_ == kNone;
        --left_;
        return true;
    }
    template <class Spoil>
    void Try(const std::string& value, Verdict verdict, const Spoil& spoil) {
        if (Skips()) return;
        left_ = kNone;
        spoil();
        done_ = Spoiled{path_, value, verdict};
    }

    static constexpr size_t kNone = ~size_t{0};
    size_t left_;  // values before the one; kNone: it is done
    const BadIds& ids_;
    std::string path_, comment_;
    std::array<const MemberComments*, 2> comments_ = {&CommentsOf({}), &CommentsOf({})};  // of where it is
    std::optional<Spoiled> done_;
};

template <>
inline constexpr SettingsHeader kSettingsHeader<BodySettings>{"Physics/Settings.h", "BodySettings"};
template <>
inline constexpr SettingsHeader kSettingsHeader<Material>{"Physics/Settings.h", "Material"};
template <>
inline constexpr SettingsHeader kSettingsHeader<SystemSettings>{"Physics/Settings.h", "SystemSettings"};
template <>
inline constexpr SettingsHeader kSettingsHeader<SolverSettings>{"Physics/Settings.h", "SolverSettings"};
template <>
inline constexpr SettingsHeader kSettingsHeader<AccuracyTarget>{"Physics/Settings.h", "AccuracyTarget"};
template <>
inline constexpr SettingsHeader kSettingsHeader<SleepSettings>{"Physics/Settings.h", "SleepSettings"};
template <>
inline constexpr SettingsHeader kSettingsHeader<EventSettings>{"Physics/Settings.h", "EventSettings"};
template <>
inline constexpr SettingsHeader kSettingsHeader<JointAnchor>{"Physics/JointSettings.h", "JointAnchor"};
template <>
inline constexpr SettingsHeader kSettingsHeader<SpringSettings>{"Constraints/Parts/SpringSettings.h", "SpringSettings"};
template <>
inline constexpr SettingsHeader kSettingsHeader<JointLimits>{"Constraints/Joints/AxisControl.h", "JointLimits"};
template <>
inline constexpr SettingsHeader kSettingsHeader<JointMotor>{"Constraints/Joints/AxisControl.h", "JointMotor"};
template <>
inline constexpr SettingsHeader kSettingsHeader<AxisControl>{"Constraints/Joints/AxisControl.h", "AxisControl"};
#define FULCRUM_JOINT_HEADER(kind)                                                                          \
    template <>                                                                                             \
    inline constexpr SettingsHeader kSettingsHeader<kind##JointSettings>{"Physics/Joints/" #kind "Joint.h", \
                                                                         #kind "JointSettings"};
FULCRUM_FOR_EACH_JOINT_KIND(FULCRUM_JOINT_HEADER)
#undef FULCRUM_JOINT_HEADER

}  // namespace fulcrum::testing
