#include <Fulcrum/Physics/Recording/CallRecorder.h>

#include <Fulcrum/Collision/Shapes/ShapeHash.h>
#include <Fulcrum/Physics/Files/ErrorBoundary.h>
#include <Fulcrum/Physics/Files/WholeFile.h>
#include <Fulcrum/Physics/Recording/CallTable.h>
#include <Fulcrum/Physics/Recording/RecordingFormat.h>

#include <algorithm>
#include <limits>
#include <unordered_map>

namespace fulcrum {

namespace {

uint32_t HashOf(const BodyInterface& bodies, BodyId id) {
    const Pose pose = bodies.GetPose(id);
    const Vector3 linear = bodies.GetLinearVelocity(id), angular = bodies.GetAngularVelocity(id);
    const Quaternion& q = pose.rotation;
    const float numbers[] = {q.x,        q.y,        q.z,         q.w,         linear.x(),
                             linear.y(), linear.z(), angular.x(), angular.y(), angular.z()};
    const double place[] = {pose.position.x(), pose.position.y(), pose.position.z()};
    uint64_t hash = HashBytes(place, sizeof place, HashBytes(numbers, sizeof numbers));
    hash = HashWord(hash, (uint64_t{id.generation} << 1) + (bodies.IsAwake(id) ? 1 : 0));
    return std::max(static_cast<uint32_t>(hash >> 32), 1u);
}

// Only for SnapshotSources of a trial: it is never called.
class NoListener final : public ContactListener {};

}  // namespace

const std::vector<BodyHash>& BodyHashes::Update(const PhysicsSystem& system) {
    next_.clear();
    system.VisitBodies([&](BodyId id) {
        next_.resize(std::max(next_.size(), size_t{id.index} + 1));
        next_[id.index] = HashOf(system.Bodies(), id);
    });
    next_.resize(std::max(next_.size(), hashes_.size()));
    hashes_.resize(next_.size());
    changed_.clear();
    for (uint32_t i = 0; i < next_.size(); ++i)
        if (next_[i] != hashes_[i]) changed_.push_back({i, next_[i]});
    hashes_.swap(next_);
    return changed_;
}

class CallRecorder::Observer final : public CallObserver, public ObjectNumbers {
public:
    Observer(PhysicsSystem& system, Sink sink, std::span<const CustomShapeFormat> customShapes)
        : system_(system), sink_(std::move(sink)), customShapes_(customShapes.begin(), customShapes.end()) {
        for (const CallRow& row : CallRows()) numbers_[row.tag] = static_cast<uint16_t>(numbers_.size());
    }
    ~Observer() override { Detach(); }

    MaybeError Begin() {
        std::vector<std::byte> head(kRecordingMagic.size() + sizeof kRecordingVersion);
        std::memcpy(head.data(), kRecordingMagic.data(), kRecordingMagic.size());
        std::memcpy(head.data() + kRecordingMagic.size(), &kRecordingVersion, sizeof kRecordingVersion);
        Send(head);
        Add(EntryKind::Functions, [&](CallWriter& writer) {
            writer.Write(static_cast<uint64_t>(CallRows().size()));
            for (const CallRow& row : CallRows()) {
                const std::string_view name(row.name);
                writer.Write(std::span<const std::byte>(std::as_bytes(std::span(name.data(), name.size()))));
                writer.Write(row.layout);
            }
        });
        if (MaybeError error = AddWorld()) return error;
        AddBodies();
        Flush();
        if (error_) return error_;
        isDetached_ = false;
        system_.SetCallObserver(this);
        return {};
    }
    const MaybeError& GetError() const { return error_; }

    // ---- CallObserver

    // What a call does must not depend on whether it is recorded: where memory runs out the recording ends.

    void BeginCall(const void* function, std::span<const void* const> arguments) override {
        OrEnd([&] { RecordCall(function, arguments); });
    }
    void NoteCreated(const void* value) override {
        OrEnd([&] {
            CreatedIds created;
            CallRows()[last_].noteCreated(value, created);
            Add(EntryKind::Created, [&](CallWriter& writer) { writer.Write(created); });
        });
    }
    void CancelCall() override {
        if (error_) return;
        if (last_ == numbers_.find(StepTag())->second) error_ = std::move(cutShort_);
        else pending_.resize(lastEntry_);
    }
    void EndStep(uint64_t stateHash) override {
        OrEnd([&] {
            Add(EntryKind::Step, [&](CallWriter& writer) { writer.Write(stateHash); });
            AddBodies();
        });
    }

    // ---- ObjectNumbers: what is new becomes an entry before that of the call, whose arguments are written aside.

    uint32_t NumberOf(const ShapePtr& shape) override {
        if (!shape) return 0;
        // An edited one is another.
        const auto [found, isNew] =
            shapes_.try_emplace({shape.get(), shape->Version()}, static_cast<uint32_t>(shapes_.size() + 1));
        if (!isNew) return found->second;
        keptShapes_.push_back(shape);  // so that no other shape gets its address
        const Result<std::vector<uint8_t>> bytes = SaveShape(*shape, customShapes_);
        const uint64_t hash = ContentHash(*shape);
        AddBytes(EntryKind::Shape, &hash, sizeof hash,
                 bytes ? std::span<const uint8_t>(bytes.Value()) : std::span<const uint8_t>());
        return found->second;
    }
    uint32_t NumberOf(const std::shared_ptr<const GroupFilter>& filter) override {
        if (!filter) return 0;
        const auto [found, isNew] = filters_.try_emplace(filter.get(), static_cast<uint32_t>(filters_.size() + 1));
        if (!isNew) return found->second;
        keptFilters_.push_back(filter);
        const auto* const table = dynamic_cast<const GroupFilterTable*>(filter.get());
        std::vector<uint32_t> pairs;
        if (table)
            for (const GroupFilterTable::Pair& pair : table->Pairs())
                pairs.insert(pairs.end(), {pair.first, pair.second});
        Add(EntryKind::Filter, [&](CallWriter& writer) {
            writer.Write(filter->ContentHash());
            writer.Write(table != nullptr);
            writer.Write(pairs);
        });
        return found->second;
    }
    uint32_t NumberOf(const ContactListener* listener) override {
        if (!listener) return 0;
        const auto found = std::ranges::find(listeners_, listener);
        if (found == listeners_.end()) listeners_.push_back(listener);
        return static_cast<uint32_t>(std::ranges::find(listeners_, listener) - listeners_.begin() + 1);
    }

    void Detach() {
        if (isDetached_) return;
        isDetached_ = true;
        system_.SetCallObserver(nullptr);
        OrEnd([&] {
            Add(EntryKind::End, [](CallWriter&) {});
            Flush();
        });
    }

private:
    template <class Work>
    void OrEnd(const Work& work) noexcept {
        if (error_) return;
        try {
            work();
        } catch (...) {
            error_ = std::move(cutShort_);
        }
    }
    void RecordCall(const void* function, std::span<const void* const> arguments) {
        const auto found = numbers_.find(function);
        if (found == numbers_.end()) {
            error_ = Error{ErrorCode::Unsupported, "a call that is not in Recording/PublicCalls.h"};
            return;
        }
        const bool isStep = function == StepTag();
        if (isStep && hasCalls_) AddBodies();
        Add(EntryKind::Call, [&](CallWriter& writer) {
            writer.Write(found->second);
            CallRows()[found->second].write(writer, arguments);
        });
        last_ = found->second;
        hasCalls_ = !isStep;
        if (isStep) Flush();
    }
    // Settings, if the world is as it was created, else a snapshot.
    MaybeError AddWorld() {
        const auto fresh = PhysicsSystem::Create(system_.Settings());
        if (fresh && fresh.Value()->HashState() == system_.HashState()) {
            Add(EntryKind::Settings, [&](CallWriter& writer) { writer.Write(system_.Settings()); });
            return {};
        }
        std::vector<std::byte> snapshot;
        if (Status saved = system_.SaveSnapshot(snapshot); !saved) return saved.GetError();
        system_.VisitBodies([&](BodyId id) {
            (void)NumberOf(system_.Bodies().GetShape(id));
            (void)NumberOf(system_.Bodies().GetGroup(id).filter);
        });
        const SnapshotSources sources{.shapes = keptShapes_, .groupFilters = keptFilters_};
        const NoListener listener;
        Status restored = fresh.Value()->RestoreSnapshot(snapshot, sources);
        const bool hasListener = !restored && restored.GetError().code == ErrorCode::Unsupported;
        if (hasListener) {
            fresh.Value()->SetContactListener(&listener);
            restored = fresh.Value()->RestoreSnapshot(snapshot, sources);
        }
        if (!restored)
            return Error{
                restored.GetError().code,
                "the world cannot be recorded from here on, but from its beginning: " + restored.GetError().message};
        if (hasListener) listeners_.push_back(nullptr);  // the first, whose address is not known
        Add(EntryKind::Snapshot, [&](CallWriter& writer) {
            writer.Write(hasListener);
            writer.Write(snapshot);
        });
        return {};
    }

    void AddBodies() {
        const std::vector<BodyHash>& changed = hashes_.Update(system_);
        const auto* const bytes = reinterpret_cast<const uint8_t*>(changed.data());
        AddBytes(EntryKind::Bodies, nullptr, 0, {bytes, changed.size() * sizeof(BodyHash)});
    }

    template <class Write>
    void Add(EntryKind kind, const Write& write) {
        std::vector<std::byte> data;
        data.swap(spare_);
        data.clear();
        CallWriter writer(data, *this);
        write(writer);
        AddBytes(kind, data.data(), data.size(), {});
        data.swap(spare_);
    }
    void AddBytes(EntryKind kind, const void* first, size_t firstSize, std::span<const uint8_t> second) {
        const uint64_t size = firstSize + second.size();
        lastEntry_ = pending_.size();
        Append(&kind, sizeof kind);
        Append(&size, sizeof size);
        Append(first, firstSize);
        Append(second.data(), second.size());
    }
    void Append(const void* data, size_t size) {
        const auto* const from = static_cast<const std::byte*>(data);
        pending_.insert(pending_.end(), from, from + size);
    }
    void Flush() {
        const uint64_t size = pending_.size();
        const RecordingPiece piece{size, HashOfSize(size), HashBytes(pending_.data(), pending_.size())};
        Send(std::as_bytes(std::span(&piece, 1)));
        Send(pending_);
        pending_.clear();
    }
    void Send(std::span<const std::byte> bytes) {
        if (!error_ && !sink_(bytes)) error_ = Error{ErrorCode::Unsupported, "the recording could not be written"};
    }

    PhysicsSystem& system_;
    Sink sink_;
    std::vector<CustomShapeFormat> customShapes_;
    MaybeError error_;
    Error cutShort_{ErrorCode::BrokenWorld, "it ends where an exception cut it, or a step, short"};  // made beforehand
    std::unordered_map<const void*, uint16_t> numbers_;  // of functions, by tag
    std::map<std::pair<const Shape*, uint64_t>, uint32_t> shapes_;
    std::unordered_map<const GroupFilter*, uint32_t> filters_;
    std::vector<ShapePtr> keptShapes_;
    std::vector<std::shared_ptr<const GroupFilter>> keptFilters_;
    std::vector<const ContactListener*> listeners_;
    std::vector<std::byte> pending_, spare_;
    BodyHashes hashes_;
    size_t lastEntry_ = 0;  // where it begins in pending_
    uint16_t last_ = 0;
    bool hasCalls_ = false, isDetached_ = true;
};

CallRecorder::CallRecorder(std::unique_ptr<Observer> observer) : observer_(std::move(observer)) {}
CallRecorder::~CallRecorder() = default;

Result<std::unique_ptr<CallRecorder>> CallRecorder::Create(PhysicsSystem& system, Sink sink,
                                                           std::span<const CustomShapeFormat> customShapes) {
    auto observer = std::make_unique<Observer>(system, std::move(sink), customShapes);
    if (MaybeError error = observer->Begin()) return *error;
    return std::unique_ptr<CallRecorder>(new CallRecorder(std::move(observer)));
}

Result<std::unique_ptr<CallRecorder>> CallRecorder::ToFile(PhysicsSystem& system, const std::string& file,
                                                           std::span<const CustomShapeFormat> customShapes) {
    return WithErrors(file, [&]() -> Result<std::unique_ptr<CallRecorder>> {
        Result<FileReplacement> opened = FileReplacement::Open(file);
        if (!opened) return Error{ErrorCode::Unsupported, opened.GetError().message};
        const auto stream = std::make_shared<FileReplacement>(std::move(opened.Value()));
        auto recorder = Create(
            system,
            [stream](std::span<const std::byte> bytes) {
                return stream->Write({reinterpret_cast<const char*>(bytes.data()), bytes.size()}) && stream->Flush();
            },
            customShapes);
        if (!recorder) return recorder;
        // It has its beginning: only now an older recording goes.
        if (const Status replaced = stream->Replace(); !replaced)
            return Error{ErrorCode::Unsupported, replaced.GetError().message};
        return recorder;
    });
}

Status CallRecorder::GetStatus() const {
    if (observer_->GetError()) return *observer_->GetError();
    return Done{};
}

}  // namespace fulcrum
