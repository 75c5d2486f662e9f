// The arguments of calls as bytes and back: plain values as they are in memory, settings field by field
// (SettingsFields.h), and shapes, group filters and listeners by their number in the recording. Used by Recording/.
#pragma once

#include <Fulcrum/Math/Hash.h>
#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/Physics/Recording/ReplaySources.h>
#include <Fulcrum/Physics/SettingsFields.h>

#include <map>
#include <set>
#include <string_view>

namespace fulcrum {

// Types without padding that own no memory; bytes of any value are valid.
template <class T>
inline constexpr bool kIsPlain =
    (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) || std::is_enum_v<T> || std::is_same_v<T, std::byte> ||
    std::is_same_v<T, Vector3> || std::is_same_v<T, Position> || std::is_same_v<T, Quaternion> ||
    std::is_same_v<T, BodyId> || std::is_same_v<T, JointId> || std::is_same_v<T, ChildId> ||
    std::is_same_v<T, SymmetricMatrix3> || std::is_same_v<T, MassOverride>;
static_assert(sizeof(BodyId) == 8 && sizeof(JointId) == 8 && sizeof(ChildId) == 8 && sizeof(MassOverride) == 16 &&
              sizeof(SymmetricMatrix3) == 24);

// Fields of structures that SettingsFields.h does not have, in the same form.
template <class Archive>
void Describe(Archive& archive, Pose& pose) {
    archive.Field("position", pose.position);
    archive.Field("rotation", pose.rotation);
}
template <class Archive>
void Describe(Archive& archive, CollisionGroup& group) {
    archive.Field("filter", group.filter);
    archive.Field("group", group.group);
    archive.Field("subGroup", group.subGroup);
}
template <class Archive>
void Describe(Archive& archive, CompoundShape::ChildSettings& child) {
    archive.Field("shape", child.shape);
    archive.Field("position", child.position);
    archive.Field("rotation", child.rotation);
    archive.Field("density", child.density);
}
// Everything of a call's settings: what files of scenes have, and what those say by names or not at all.
template <class Archive, class T>
void DescribeWhole(Archive& archive, T& value) {
    if constexpr (std::is_base_of_v<JointSettings, T>) {
        archive.Field("bodyA", value.bodyA);
        archive.Field("bodyB", value.bodyB);
    }
    if constexpr (std::is_same_v<T, CustomJointSettings>) DescribeShared(archive, value);
    else Describe(archive, value);
    if constexpr (std::is_same_v<T, BodySettings>) archive.Field("group", value.group);
}

// A value that a call may have as an argument, as long as it is stored: what spans refer to is owned.
template <class T>
struct StoredArgument {
    using Type = T;
};
template <class T>
struct StoredArgument<std::span<const T>> {
    using Type = std::vector<T>;
};
// A batch before it is prepared.
struct BatchSettings {
    std::vector<BodySettings> bodies;
    std::vector<BodyBatch::Joint> joints;
};
// Default settings of the kind that has this index.
inline BodyBatch::Joint JointOfKind(size_t kind) {
    BodyBatch::Joint joint;
    [&]<size_t... index>(std::index_sequence<index...>) {
        ((index == kind ? void(joint.emplace<index>()) : void()), ...);
    }
    (std::make_index_sequence<std::variant_size_v<BodyBatch::Joint>>());
    return joint;
}
template <class Archive>
void Describe(Archive& archive, BatchSettings& batch) {
    archive.Field("bodies", batch.bodies);
    archive.Field("joints", batch.joints);
}
template <>
struct StoredArgument<BodyBatch> {
    using Type = BatchSettings;
};

// The numbers that objects have in a recording. 0: null.
class ObjectNumbers {
public:
    virtual ~ObjectNumbers() = default;
    virtual uint32_t NumberOf(const ShapePtr& shape) = 0;
    virtual uint32_t NumberOf(const std::shared_ptr<const GroupFilter>& filter) = 0;
    virtual uint32_t NumberOf(const ContactListener* listener) = 0;
};

class CallWriter {
public:
    CallWriter(std::vector<std::byte>& bytes, ObjectNumbers& objects) : bytes_(bytes), objects_(objects) {}

    template <class T>
    void Field(const char*, T& value) {
        Write(value);
    }
    template <class E, class Names>
    void Choice(const char*, E& value, const Names&) {
        Write(value);
    }

    template <class T>
    void Write(const T& value) {
        if constexpr (kIsPlain<T>) Raw(&value, sizeof value);
        else if constexpr (std::is_same_v<T, bool>) Write(static_cast<uint8_t>(value));
        else if constexpr (std::is_same_v<T, ShapePtr> || std::is_same_v<T, std::shared_ptr<const GroupFilter>> ||
                           std::is_same_v<T, const ContactListener*>)
            Write(objects_.NumberOf(value));
        else if constexpr (std::is_same_v<T, std::shared_ptr<const Path>>) WritePath(value);
        else if constexpr (std::is_same_v<T, BodyBatch>) WriteBatch(value);
        else if constexpr (std::is_same_v<T, SnapshotSources>) WriteSources(value);
        else WriteStructure(value);
    }

private:
    template <class T>
    void WriteStructure(const T& value) {
        DescribeWhole(*this, const_cast<T&>(value));  // writing changes nothing
    }
    void WriteStructure(const BodyBatch::Joint& joint) {
        Write(static_cast<uint8_t>(joint.index()));
        std::visit([&](const auto& settings) { Write(settings); }, joint);
    }
    template <class T>
    void WriteStructure(const std::optional<T>& value) {
        Write(value.has_value());
        if (value) Write(*value);
    }
    template <class T, size_t kSize>
    void WriteStructure(const std::array<T, kSize>& values) {
        for (const T& value : values) Write(value);
    }
    template <class T>
    void WriteStructure(const std::vector<T>& values) {
        WriteAll(std::span<const T>(values));
    }
    template <class T>
    void WriteStructure(const std::span<const T>& values) {
        WriteAll(values);
    }
    template <class T>
    void WriteAll(std::span<const T> values) {
        Write(static_cast<uint64_t>(values.size()));
        if constexpr (std::is_same_v<T, std::byte>) Raw(values.data(), values.size());
        else
            for (const T& value : values) Write(value);
    }
    void WriteBatch(const BodyBatch& batch) {
        WriteAll(batch.Bodies());
        WriteAll(batch.Joints());
    }
    void WritePath(const std::shared_ptr<const Path>& path) {
        Write(path != nullptr);
        if (!path) return;
        Write(path->IsClosed());
        WriteAll(path->Points());
    }
    // So that they are in the recording: a replay gives all that it has.
    void WriteSources(const SnapshotSources& sources) {
        for (const ShapePtr& shape : sources.shapes) (void)objects_.NumberOf(shape);
        for (const std::shared_ptr<const GroupFilter>& filter : sources.groupFilters) (void)objects_.NumberOf(filter);
    }
    void Raw(const void* data, size_t size) {
        const auto* const from = static_cast<const std::byte*>(data);
        bytes_.insert(bytes_.end(), from, from + size);
    }

    std::vector<std::byte>& bytes_;
    ObjectNumbers& objects_;
};

// The objects of a recording, by number - 1.
struct RecordedObjects {
    std::vector<ShapePtr> shapes;
    std::vector<std::shared_ptr<const GroupFilter>> filters;
};

// The ids of a recording where some of its calls are left out: recorded ids by those that the same calls give now.
struct RecordedIds {
    std::set<BodyId> allBodies;  // that some call of the recording creates
    std::set<JointId> allJoints;
    std::map<BodyId, BodyId> bodies;  // of those that exist or existed
    std::map<JointId, JointId> joints;
};

// Never reads beyond the end: IsBad() then.
class CallReader {
public:
    CallReader(std::span<const std::byte> bytes, const RecordedObjects& objects, const ReplaySources& sources,
               const RecordedIds* ids)
        : at_(bytes.data()), end_(bytes.data() + bytes.size()), objects_(objects), sources_(sources), ids_(ids) {}

    template <class T>
    void Field(const char*, T& value) {
        Read(value);
    }
    template <class E, class Names>
    void Choice(const char*, E& value, const Names&) {
        Read(value);
    }

    template <class T>
    void Read(T& value) {
        if constexpr (kIsPlain<T>) {
            Raw(&value, sizeof value);
            if constexpr (std::is_same_v<T, BodyId> || std::is_same_v<T, JointId>) Translate(value);
        } else if constexpr (std::is_same_v<T, bool>) {
            value = Get<uint8_t>() != 0;
        } else if constexpr (std::is_same_v<T, ShapePtr>) {
            ReadObject(objects_.shapes, value);
        } else if constexpr (std::is_same_v<T, std::shared_ptr<const GroupFilter>>) {
            ReadObject(objects_.filters, value);
        } else if constexpr (std::is_same_v<T, const ContactListener*>) {
            const uint32_t number = Get<uint32_t>();
            lacksListener_ |= number > sources_.contactListeners.size();
            value = number == 0 || lacksListener_ ? nullptr : sources_.contactListeners[number - 1];
        } else if constexpr (std::is_same_v<T, std::shared_ptr<const Path>>) {
            ReadPath(value);
        } else if constexpr (std::is_same_v<T, SnapshotSources>) {
            value.shapes = objects_.shapes;
            value.groupFilters = objects_.filters;
            value.makeJoint = sources_.makeJoint;
        } else {
            ReadStructure(value);
        }
    }

    bool IsBad() const { return isBad_; }
    bool IsAtEnd() const { return at_ == end_; }
    // Names a body or joint whose call was left out.
    bool NamesWhatIsMissing() const { return namesMissing_; }
    bool LacksListener() const { return lacksListener_; }
    const ReplaySources& Sources() const { return sources_; }

private:
    template <class T>
    T Get() {
        T value{};
        Read(value);
        return value;
    }
    template <class T>
    void ReadStructure(T& value) {
        DescribeWhole(*this, value);
    }
    void ReadStructure(BodyBatch::Joint& joint) {
        const uint8_t kind = Get<uint8_t>();
        isBad_ |= kind >= std::variant_size_v<BodyBatch::Joint>;
        if (isBad_) return;
        joint = JointOfKind(kind);
        std::visit([&](auto& settings) { Read(settings); }, joint);
    }
    template <class T>
    void ReadStructure(std::optional<T>& value) {
        value.reset();
        if (!Get<bool>()) return;
        value.emplace();
        Read(*value);
    }
    template <class T, size_t kSize>
    void ReadStructure(std::array<T, kSize>& values) {
        for (T& value : values) Read(value);
    }
    template <class T>
    void ReadStructure(std::vector<T>& values) {
        const uint64_t count = Get<uint64_t>();
        if (isBad_ || count > static_cast<size_t>(end_ - at_)) {  // an element has a byte at least
            isBad_ = true;
            return;
        }
        if constexpr (std::is_same_v<T, std::byte>) {
            values.resize(count);
            Raw(values.data(), values.size());
            return;
        }
        // One by one: a damaged number must not ask for more memory than there is.
        values.clear();
        while (values.size() < count && !isBad_) Read(values.emplace_back());
    }
    template <class T>
    void ReadObject(const std::vector<T>& objects, T& object) {
        const uint32_t number = Get<uint32_t>();
        isBad_ |= number > objects.size();
        object = number == 0 || isBad_ ? nullptr : objects[number - 1];
    }
    void ReadPath(std::shared_ptr<const Path>& path) {
        path = nullptr;
        if (!Get<bool>()) return;
        const bool isClosed = Get<bool>();
        std::vector<PathPoint> points;
        Read(points);
        const auto made = Path::Hermite(points, isClosed);
        isBad_ |= !made;
        if (made) path = made.Value();
    }
    void Translate(BodyId& id) {
        if (ids_) Translate(id, ids_->allBodies, ids_->bodies);
    }
    void Translate(JointId& id) {
        if (ids_) Translate(id, ids_->allJoints, ids_->joints);
    }
    template <class Id>
    void Translate(Id& id, const std::set<Id>& all, const std::map<Id, Id>& now) {
        const auto found = now.find(id);
        if (found != now.end()) id = found->second;
        else namesMissing_ |= all.contains(id);
    }
    void Raw(void* data, size_t size) {
        isBad_ |= size > static_cast<size_t>(end_ - at_);
        if (isBad_ || size == 0) return;
        std::memcpy(data, at_, size);
        at_ += size;
    }

    const std::byte* at_;
    const std::byte* end_;
    const RecordedObjects& objects_;
    const ReplaySources& sources_;
    const RecordedIds* ids_;
    bool isBad_ = false, namesMissing_ = false, lacksListener_ = false;
};

// A hash of names and sizes of all fields: equal if arguments can be read by this build as they were written.
class CallLayout {
public:
    template <class T>
    void Field(const char* name, T&) {
        Name(name);
        Add<T>();
    }
    template <class E, class Names>
    void Choice(const char* name, E&, const Names&) {
        Name(name);
        Add<E>();
    }

    template <class T>
    void Add() {
        if constexpr (kIsPlain<T> || std::is_same_v<T, bool>) hash_ = HashWord(hash_, sizeof(T));
        else if constexpr (std::is_same_v<T, ShapePtr> || std::is_same_v<T, std::shared_ptr<const GroupFilter>> ||
                           std::is_same_v<T, const ContactListener*> || std::is_same_v<T, SnapshotSources>)
            Name("object");
        else if constexpr (std::is_same_v<T, std::shared_ptr<const Path>>) Add<std::vector<PathPoint>>();
        else AddStructure(static_cast<T*>(nullptr));
    }
    uint64_t Hash() const { return hash_; }

private:
    void Name(std::string_view name) { hash_ = HashBytes(name.data(), name.size(), hash_); }
    template <class T>
    void AddStructure(T*) {
        T value{};
        DescribeWhole(*this, value);
    }
    template <class... Kinds>
    void AddStructure(std::variant<Kinds...>*) {
        Name("any of");
        (Add<Kinds>(), ...);
    }
    template <class T>
    void AddStructure(std::optional<T>*) {
        Name("optional");
        Add<T>();
    }
    template <class T, size_t kSize>
    void AddStructure(std::array<T, kSize>*) {
        hash_ = HashWord(hash_, kSize);
        Add<T>();
    }
    template <class T>
    void AddStructure(std::vector<T>*) {
        Name("list");
        Add<T>();
    }

    uint64_t hash_ = kHashSeed;
};

}  // namespace fulcrum
