// Sensors: every awake body searches the sensors' tree along its whole path; moving sensors search for resting bodies.
// Resting bodies in resting sensors stay in their lists without tests. Candidates are sorted by ids before their shapes
// are tested, so that events do not depend on threads.
#include <Fulcrum/Physics/Stages/SensorVisits.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/World/FatBounds.h>
#include <Fulcrum/Physics/World/Filters.h>

#include <algorithm>
#include <tuple>

namespace fulcrum {

namespace {

SensorSees KindOf(const BodyDynamics& d) {
    return d.motion == MotionType::Static      ? SensorSees::Static
           : d.motion == MotionType::Kinematic ? SensorSees::Kinematic
                                               : SensorSees::Dynamic;
}

bool Sees(const CollisionView& view, const Sensor& sensor, uint32_t body) {
    const uint32_t self = sensor.id.index;
    const BodyDynamics& d = view.bodies.dynamics[body];
    if (body == self || !(sensor.sees & KindOf(d))) return false;
    if (d.motion == MotionType::Dynamic && !d.awake && !(sensor.sees & SensorSees::Sleeping)) return false;
    if (view.bodies.cold[body].isSensor && !(sensor.sees & SensorSees::Sensors)) return false;
    if (!(view.step.settings.layerCollides[view.bodies.dynamics[self].layer] >> d.layer & 1u)) return false;
    if ((d.special || view.bodies.dynamics[self].special) && !FiltersAllow(view.bodies, self, body)) return false;
    return !view.joints.ForbidsContact(self, body);
}

bool IsTouched(const StepContext& step, const SensorSearch& sensing, uint32_t body) {
    return sensing.changedIn[body] == step.number;
}
// Whether it has not moved since the end of the last step.
bool Rests(const CollisionView& view, const SensorSearch& sensing, uint32_t body) {
    return !view.bodies.dynamics[body].awake && !IsTouched(view.step, sensing, body);
}

void NoteTouched(const CollisionView& view, SensorStore& store, SensorSearch& sensing,
                 std::span<WorkerFindings> workers) {
    sensing.changedIn.resize(view.bodies.Size(), 0);
    for (uint32_t body : store.changed)
        if (view.bodies.cold[body].exists) sensing.changedIn[body] = view.step.number;
    store.changed.reserve(view.colliders.colliders.capacity());
    for (WorkerFindings& findings : workers) {
        findings.sensorCandidates.reserve(sensing.candidates.capacity());
        findings.sensorVisits.reserve(sensing.visits.capacity());
        findings.sensorTests = 0;
    }
}

// The segments of the paths cut by hits, sorted by body and time.
void CollectCutWays(const SweepStore& sweeps, Array<MotionSegment>& cut) {
    cut.clear();
    for (size_t i = 0; i < sweeps.ended.size(); ++i)
        if (sweeps.ended[i].from < sweeps.endedAt[i]) cut.push_back({sweeps.ended[i], sweeps.endedAt[i]});
    for (const Sweep& sweep : sweeps.swept)
        if (sweep.isCut && sweep.from < 1) cut.push_back({sweep, 1});
    std::sort(cut.begin(), cut.end(), [](const MotionSegment& a, const MotionSegment& b) {
        return std::tie(a.sweep.body, a.sweep.from) < std::tie(b.sweep.body, b.sweep.from);
    });
}

// Sensors must be found along their whole path in this step, and by queries at their current pose.
void EnlargeSensorBounds(const StepContext& step, const BodyStore& bodies, const SensorStore& sensors,
                         const SweepStore& sweeps, std::span<const MotionSegment> cut, ColliderStore& colliders) {
    for (const Sensor& sensor : sensors.sensors) {
        const uint32_t body = sensor.id.index;
        if (sensor.removed || !bodies.dynamics[body].awake) continue;
        const MotionPath path(step, bodies, sweeps, cut, body);
        VisitColliders(bodies, colliders, body, [&](uint32_t i) {
            Bounds bounds = PieceBounds(bodies, colliders, path, i);
            bounds.Include(TightBoundsOf(bodies, colliders, i));
            Collider& collider = colliders.colliders[i];
            if (collider.fat.Contains(bounds)) return;
            collider.fat.Include(bounds);
            colliders.sensorTree.Update(i, collider.fat);
        });
    }
    colliders.sensorTree.Optimize();
}

// Bounds of the body's bounding sphere along its whole path.
Bounds RoundBounds(const CollisionView& view, const SweepStore& sweeps, std::span<const MotionSegment> cut,
                   uint32_t body) {
    const Position reach = Position::Constant(double{view.bodies.dynamics[body].outerRadius});
    Position lower = view.bodies.CenterOf(body), upper = lower;
    const auto include = [&](const Position& center) {
        lower = lower.cwiseMin(center);
        upper = upper.cwiseMax(center);
    };
    const SweepStore::Start* starts = sweeps.starts.data();
    if (body < sweeps.starts.size() && starts[body].step == view.step.number) include(starts[body].pose.position);
    for (const MotionSegment& segment : CutSegmentsOf(cut, body)) include(segment.sweep.start.position);
    const Position& origin = view.colliders.boundsOrigin;
    return RoundedOutwards(lower - origin - reach, upper - origin + reach);
}

void AddCandidate(const CollisionView& view, const SensorStore& store, uint32_t sensorBody, uint32_t body,
                  WorkerFindings& findings) {
    const uint32_t place = store.PlaceOf(view.bodies.IdOf(sensorBody));
    if (Sees(view, store.sensors[place], body)) findings.sensorCandidates.push_back(uint64_t(place) << 32 | body);
}

void SearchFromBody(const CollisionView& view, const SensorStore& store, const SweepStore& sweeps,
                    std::span<const MotionSegment> cut, uint32_t body, WorkerFindings& findings) {
    const ColliderStore& colliders = view.colliders;
    colliders.sensorTree.Query(RoundBounds(view, sweeps, cut, body), [&](uint32_t i) {
        AddCandidate(view, store, colliders.colliders[i].body, body, findings);
    });
}

// Bodies that are awake or were changed search for themselves.
void SearchFromSensor(const CollisionView& view, const SensorStore& store, const SensorSearch& sensing,
                      const Sensor& sensor, WorkerFindings& findings) {
    if (sensor.removed || Rests(view, sensing, sensor.id.index)) return;
    const ColliderStore& colliders = view.colliders;
    VisitColliders(view.bodies, view.colliders, sensor.id.index, [&](uint32_t i) {
        const auto visit = [&](uint32_t other) {
            const uint32_t body = colliders.colliders[other].body;
            if (Rests(view, sensing, body)) AddCandidate(view, store, sensor.id.index, body, findings);
        };
        const Bounds& bounds = colliders.colliders[i].fat;
        colliders.movingTree.Query(bounds, visit);
        if (sensor.sees & SensorSees::Static) colliders.staticTree.Query(bounds, visit);
        if (sensor.sees & SensorSees::Sensors) colliders.sensorTree.Query(bounds, visit);
    });
}

void FindCandidates(const CollisionView& view, const SensorStore& store, const SweepStore& sweeps,
                    SensorSearch& sensing, const StepWorkers& workers) {
    const auto forEach = [&](size_t count, uint32_t minimumRange, const auto& search) {
        workers.jobs.ParallelFor(static_cast<uint32_t>(count), minimumRange, [&](JobRange range) {
            for (uint32_t i = range.begin; i < range.end; ++i) search(i, workers.findings[range.worker]);
        });
    };
    const Array<uint32_t>& awake = view.bodies.awake;
    forEach(awake.size(), 128, [&](uint32_t i, WorkerFindings& findings) {
        SearchFromBody(view, store, sweeps, sensing.cut, awake[i], findings);
    });
    forEach(store.changed.size(), 128, [&](uint32_t i, WorkerFindings& findings) {
        const uint32_t body = store.changed[i];
        if (view.bodies.cold[body].exists && !view.bodies.dynamics[body].awake)
            SearchFromBody(view, store, sweeps, sensing.cut, body, findings);
    });
    forEach(store.sensors.size(), 1, [&](uint32_t i, WorkerFindings& findings) {
        SearchFromSensor(view, store, sensing, store.sensors[i], findings);
    });

    Array<uint64_t>& candidates = sensing.candidates;
    candidates.clear();
    for (WorkerFindings& findings : workers.findings) {
        candidates.insert(candidates.end(), findings.sensorCandidates.begin(), findings.sensorCandidates.end());
        findings.sensorCandidates.clear();
    }
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
}

void LookAtCandidate(const CollisionView& view, const SensorStore& store, const SweepStore& sweeps,
                     const SensorSearch& sensing, uint64_t candidate, WorkerFindings& findings) {
    const uint32_t place = static_cast<uint32_t>(candidate >> 32), body = static_cast<uint32_t>(candidate);
    const Sensor& sensor = store.sensors[place];
    AtStart atStart = AtStart::Unknown;
    if (!IsTouched(view.step, sensing, body) && !IsTouched(view.step, sensing, sensor.id.index)) {
        const bool wasInside = std::binary_search(sensor.inside.begin(), sensor.inside.end(), view.bodies.IdOf(body));
        atStart = wasInside ? AtStart::Inside : AtStart::Outside;
    }
    ++findings.sensorTests;
    // Fast path: most bodies inside stay there.
    if (atStart == AtStart::Inside && IsOnePiece(view.bodies, body) && IsOnePiece(view.bodies, sensor.id.index) &&
        CutSegmentsOf(sensing.cut, body).empty() && OverlapAtEnd(view, sensor.id.index, body)) {
        findings.sensorVisits.push_back({place, body, 0, 1, true, true});
        return;
    }
    FindVisits(view, place, MotionPath(view.step, view.bodies, sweeps, sensing.cut, sensor.id.index),
               MotionPath(view.step, view.bodies, sweeps, sensing.cut, body), atStart, findings.sensorVisits);
}

void FindAllVisits(const CollisionView& view, const SensorStore& store, const SweepStore& sweeps, SensorSearch& sensing,
                   const StepWorkers& workers, StepReport& report) {
    workers.jobs.ParallelFor(static_cast<uint32_t>(sensing.candidates.size()), 4, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i)
            LookAtCandidate(view, store, sweeps, sensing, sensing.candidates[i], workers.findings[range.worker]);
    });
    sensing.visits.clear();
    for (WorkerFindings& findings : workers.findings) {
        sensing.visits.insert(sensing.visits.end(), findings.sensorVisits.begin(), findings.sensorVisits.end());
        findings.sensorVisits.clear();
        report.sensorTests += findings.sensorTests;
    }
    std::sort(sensing.visits.begin(), sensing.visits.end(), [](const SensorVisit& a, const SensorVisit& b) {
        return std::tie(a.sensor, a.body, a.from) < std::tie(b.sensor, b.body, b.from);
    });
}

// Computes events and the new list of one sensor by merging the old list and the candidates, both sorted by body.
class Reporter {
public:
    Reporter(const CollisionView& view, const SensorSearch& sensing, Sensor& sensor, uint32_t place)
        : view_(view), sensing_(sensing), sensor_(sensor) {
        const uint64_t key = uint64_t(place) << 32;
        candidate_ = std::lower_bound(sensing.candidates.begin(), sensing.candidates.end(), key);
        lastCandidate_ = std::lower_bound(candidate_, sensing.candidates.end(), key + (uint64_t(1) << 32));
        visit_ = std::lower_bound(sensing.visits.begin(), sensing.visits.end(), place,
                                  [](const SensorVisit& v, uint32_t p) { return v.sensor < p; });
        lastVisit_ = sensing.visits.end();
        place_ = place;
    }

    void Run() {
        sensor_.events.clear();
        sensor_.insideNext.clear();
        for (const BodyId id : sensor_.inside) {
            while (candidate_ != lastCandidate_ && Candidate() < id.index) ReportCandidate(false);
            if (candidate_ != lastCandidate_ && view_.bodies.IdOf(Candidate()) == id) ReportCandidate(true);
            else if (RestsInside(id)) Keep(id, true);
            else Report(id, SensorEvent::Kind::End, 0);
        }
        while (candidate_ != lastCandidate_) ReportCandidate(false);
        sensor_.inside.swap(sensor_.insideNext);
        std::sort(sensor_.events.begin(), sensor_.events.end(), [](const SensorEvent& a, const SensorEvent& b) {
            return std::tie(a.time, a.body, a.kind) < std::tie(b.time, b.body, b.kind);
        });
    }

private:
    uint32_t Candidate() const { return static_cast<uint32_t>(*candidate_); }

    bool RestsInside(BodyId id) const {
        if (sensor_.removed || !view_.bodies.Find(id)) return false;
        return Rests(view_, sensing_, sensor_.id.index) && Rests(view_, sensing_, id.index) &&
               Sees(view_, sensor_, id.index);
    }

    void Report(BodyId id, SensorEvent::Kind kind, float time) {
        sensor_.events.push_back({sensor_.id, id, kind, time});
    }

    void Keep(BodyId id, bool stayed) {
        sensor_.insideNext.push_back(id);
        if (stayed && sensor_.reportsStay) Report(id, SensorEvent::Kind::Stay, 1);
    }

    void ReportCandidate(bool wasInside) {
        const uint32_t body = Candidate();
        const BodyId id = view_.bodies.IdOf(body);
        bool inside = wasInside, stayed = wasInside;
        for (; visit_ != lastVisit_ && visit_->sensor == place_ && visit_->body == body; ++visit_) {
            if (!(inside && visit_->atStart)) {
                if (inside) Report(id, SensorEvent::Kind::End, 0);
                Report(id, SensorEvent::Kind::Begin, visit_->from);
                stayed = false;
            }
            inside = visit_->atEnd;
            if (!inside) Report(id, SensorEvent::Kind::End, visit_->until);
            wasInside = false;
        }
        if (wasInside) Report(id, SensorEvent::Kind::End, 0);
        else if (inside) Keep(id, stayed);
        ++candidate_;
    }

    const CollisionView& view_;
    const SensorSearch& sensing_;
    Sensor& sensor_;
    uint32_t place_;
    Array<uint64_t>::const_iterator candidate_, lastCandidate_;
    Array<SensorVisit>::const_iterator visit_, lastVisit_;
};

void ReportAll(const CollisionView& view, SensorStore& store, const SensorSearch& sensing, JobSystem& jobs,
               StepReport& report) {
    jobs.ParallelFor(static_cast<uint32_t>(store.sensors.size()), 1, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) Reporter(view, sensing, store.sensors[i], i).Run();
    });
    for (const Sensor& sensor : store.sensors)
        store.events.insert(store.events.end(), sensor.events.begin(), sensor.events.end());
    report.sensorEvents = static_cast<uint32_t>(store.events.size());
    std::erase_if(store.sensors, [](const Sensor& sensor) { return sensor.removed; });
}

}  // namespace

void Sense(const StepContext& step, const BodyStore& bodies, const JointStore& joints, const SweepStore& sweeps,
           SensorStore& sensors, ColliderStore& colliders, SensorSearch& sensing, const StepWorkers& workers,
           StepReport& report) {
    if (sensors.IsEmpty()) return;
    const CollisionView view{step, bodies, colliders, joints};
    NoteTouched(view, sensors, sensing, workers.findings);
    CollectCutWays(sweeps, sensing.cut);
    EnlargeSensorBounds(step, bodies, sensors, sweeps, sensing.cut, colliders);
    FindCandidates(view, sensors, sweeps, sensing, workers);
    FindAllVisits(view, sensors, sweeps, sensing, workers, report);
    ReportAll(view, sensors, sensing, workers.jobs, report);
    sensors.changed.clear();
}

}  // namespace fulcrum
