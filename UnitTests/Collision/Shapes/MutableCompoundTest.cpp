// Edits of a mutable compound against a static compound that is created from a list of its children.
#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Queries/RayCast.h>
#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/MassProperties.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/Scaled.h>
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace fulcrum::testing {
namespace {

using ChildSettings = CompoundShape::ChildSettings;

class RandomChildren {
public:
    explicit RandomChildren(uint32_t seed) : random(seed) {
        const Vector3 wedge[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
        shapes = {Sphere::Create(0.4f).Value(), Box::Create(Vector3(0.5f, 0.2f, 0.7f)).Value(),
                  Capsule::Create(0.3f, 0.2f).Value(), ConvexHull::Create(wedge).Value()};
    }
    uint32_t Below(uint32_t count) {
        return std::min(static_cast<uint32_t>(random.Between(0, static_cast<float>(count))), count - 1);
    }
    ChildSettings Next() {
        ChildSettings child;
        child.shape = shapes[Below(4)];
        child.position = random.InCube() * 10 + Vector3(3, 0, 0);
        child.rotation = random.Rotation();
        child.density = random.Between(0.1f, 10);
        return child;
    }
    std::vector<ChildSettings> Next(int count) {
        std::vector<ChildSettings> children;
        for (int i = 0; i < count; ++i) children.push_back(Next());
        return children;
    }

    RandomPoses random;
    std::vector<ShapePtr> shapes;
};

Sym3<double> InertiaOfShape(const Shape& shape) { return ToSolidMass(shape.Mass()).inertia; }

// The mass of the one is that of the other, to float's rounding of children's places of some 10 m.
void ExpectSameMass(const Shape& a, const Shape& b) {
    const double size = double{b.OuterRadius()};
    EXPECT_NEAR(double{a.Mass().volume}, double{b.Mass().volume}, 1e-6 * double{b.Mass().volume});
    EXPECT_LT(Length(Vector3(a.Mass().centerOfMass - b.Mass().centerOfMass)), 1e-6 * size);
    const Sym3<double> i = InertiaOfShape(a), j = InertiaOfShape(b);
    const double tolerance = 3e-6 * std::max({i.xx, i.yy, i.zz});
    const double differences[] = {i.xx - j.xx, i.yy - j.yy, i.zz - j.zz, i.xy - j.xy, i.xz - j.xz, i.yz - j.yz};
    for (const double d : differences) EXPECT_LT(std::fabs(d), tolerance);
}

TEST(MutableCompound, IsWhatTheStaticCompoundOfItsChildrenIs) {
    RandomChildren random(1);
    for (int count : {1, 2, 7, 8, 9, 63, 64, 65, 600}) {
        const std::vector<ChildSettings> children = random.Next(count);
        const auto still = Compound::Create(children).Value();
        const auto compound = MutableCompound::Create(children).Value();
        EXPECT_EQ(compound->Count(), static_cast<uint32_t>(count));
        ExpectSameMass(*compound, *still);
        EXPECT_EQ(compound->InnerRadius(), still->InnerRadius());
        // A box's corner is up to sqrt(3) times as far as what touches its sides.
        EXPECT_GE(compound->OuterRadius(), 0.99999f * still->OuterRadius());
        EXPECT_LE(compound->OuterRadius(), 1.7321f * still->OuterRadius());
        EXPECT_LT(Length(Vector3(compound->LocalBounds().lower - still->LocalBounds().lower)), 1e-5f);
        EXPECT_LT(Length(Vector3(compound->LocalBounds().upper - still->LocalBounds().upper)), 1e-5f);
        EXPECT_EQ(compound->Settings().size(), children.size());
        for (size_t i = 0; i < children.size(); ++i) {
            const ChildSettings again = compound->Settings()[i];
            EXPECT_EQ(again.shape, children[i].shape);
            EXPECT_LT(Length(Vector3(again.position - children[i].position)), 1e-5f);
            EXPECT_EQ(again.density, children[i].density);
        }
    }
}

// Query results of a shape in the user's frame, whatever its center of mass.
void ExpectSameQueries(const MutableCompound& compound, const std::map<ChildId, ChildSettings>& children,
                       RandomPoses& random) {
    const Pose user{Position(1, 2, 3), random.Rotation()};
    const Pose pose{user.Transform(compound.Mass().centerOfMass), user.rotation};
    const auto centerOf = [&](const ChildSettings& child) {
        const RelativePose at{child.position, child.rotation};
        return user * RelativePose{at.Transform(child.shape->Mass().centerOfMass), child.rotation};
    };
    for (int i = 0; i < 3; ++i) {
        const Vector3 from = random.InCube() * 15, to = random.InCube() * 10;
        const Ray ray{user.Transform(from), Rotate(user.rotation, Vector3((to - from) * 1.5f))};
        const RayCaster caster(ray);
        RayHit hit, best;
        ChildId bestChild;
        RayCastSettings upTo;
        for (const auto& [id, child] : children) {
            if (!caster.CastClosest(*child.shape, centerOf(child), upTo, best)) continue;
            upTo.maxFraction = best.fraction;
            bestChild = id;
        }
        const bool isHit = caster.CastClosest(compound, pose, {}, hit);
        // Rays within rounding of a silhouette may be told either way, or name the neighbor at the same place.
        if (isHit != (bestChild.index != ~0u)) continue;
        if (!isHit) continue;
        EXPECT_NEAR(double{hit.fraction}, double{upTo.maxFraction}, 1e-4);
        if (std::fabs(hit.fraction - upTo.maxFraction) < 1e-5f) {
            EXPECT_EQ(compound.IdOf(hit.subShape.child), bestChild);
        }
    }
    // The closest child of a point.
    const Vector3 point = random.InCube() * 12;
    float closest = 1e9f;
    for (const auto& [id, child] : children) {
        ClosestPoints found;
        const RelativePose own{child.position, child.rotation};
        const Vector3 inChild = own.InverseTransform(point) - child.shape->Mass().centerOfMass;
        if (FindClosestPoint(*child.shape, inChild, 1e9f, found)) closest = std::min(closest, found.distance);
    }
    ClosestPoints found;
    ASSERT_TRUE(FindClosestPoint(compound, point - compound.Mass().centerOfMass, 1e9f, found));
    EXPECT_NEAR(found.distance, closest, 2e-5f);
}

TEST(MutableCompound, TenThousandEditsAreThoseOfAList) {
    RandomChildren random(2);
    std::map<ChildId, ChildSettings> list;
    const std::vector<ChildSettings> first = random.Next(20);
    const auto compound = MutableCompound::Create(first).Value();
    for (uint32_t i = 0; i < first.size(); ++i) list[{i, 0}] = first[i];
    std::vector<ChildId> removed;
    for (int edit = 0; edit < 10000; ++edit) {
        const auto any = std::next(list.begin(), random.Below(static_cast<uint32_t>(list.size())));
        switch (random.Below(list.size() < 120 ? 5 : 8)) {
            case 0:
            case 1:
            case 2: {
                const ChildSettings child = random.Next();
                const ChildId id = compound->Add(child).Value();
                ASSERT_TRUE(list.emplace(id, child).second);
                break;
            }
            case 3: {
                any->second.position = random.random.InCube() * 10;
                any->second.rotation = random.random.Rotation();
                ASSERT_TRUE(compound->Move(any->first, any->second.position, any->second.rotation));
                break;
            }
            case 4:
                any->second = random.Next();
                ASSERT_TRUE(compound->Set(any->first, any->second));
                break;
            default:
                removed.push_back(any->first);
                ASSERT_TRUE(compound->Remove(any->first));
                list.erase(any);
                break;
        }
        ASSERT_EQ(compound->Count(), list.size());
        if (edit % 100 != 0) continue;
        std::vector<ChildSettings> children;
        for (const auto& [id, child] : list) children.push_back(child);
        ExpectSameMass(*compound, *Compound::Create(children).Value());
        ExpectSameQueries(*compound, list, random.random);
        compound->Tree().Validate();
        for (const auto& [id, child] : list) {
            EXPECT_TRUE(compound->Exists(id));
            EXPECT_EQ(compound->IdOf(id.index), id);
        }
        for (const ChildId id : removed) EXPECT_FALSE(compound->Exists(id));
    }
    EXPECT_GT(removed.size(), 3000u);
}

TEST(MutableCompound, KeepsNoTraceOfEditsThatWereTakenBack) {
    // Masses are sums by index, not running totals: nothing is left of a child a million times as heavy.
    RandomChildren random(3);
    const std::vector<ChildSettings> children = random.Next(100);
    const auto compound = MutableCompound::Create(children).Value(), never = MutableCompound::Create(children).Value();
    ChildSettings heavy = random.Next();
    heavy.density = 1e9f;
    for (uint32_t round = 0; round < 50; ++round) {
        const ChildId added = compound->Add(heavy).Value(), moved{random.Below(100), 0};
        const Vector3 place = random.random.InCube() * 1000;
        ASSERT_TRUE(compound->Move(moved, place, random.random.Rotation()));
        ASSERT_TRUE(compound->Set(moved, children[moved.index]));
        ASSERT_TRUE(compound->Remove(added));
    }
    EXPECT_EQ(compound->Mass().volume, never->Mass().volume);
    EXPECT_EQ(compound->Mass().centerOfMass, never->Mass().centerOfMass);
    EXPECT_EQ(compound->Mass().principalInertia, never->Mass().principalInertia);
    EXPECT_EQ(compound->RelativeMass(), never->RelativeMass());
    EXPECT_EQ(compound->OuterRadius(), never->OuterRadius());
    EXPECT_EQ(compound->LocalBounds().lower, never->LocalBounds().lower);
}

TEST(MutableCompound, TheMassMayStay) {
    RandomChildren random(4);
    const std::vector<ChildSettings> children = random.Next(10);
    const auto compound = MutableCompound::Create(children).Value();
    const MassProperties before = compound->Mass();
    ASSERT_TRUE(compound->Remove({3, 0}, MassUpdate::Keep));
    ASSERT_TRUE(compound->Move({5, 0}, {1, 1, 1}, {}, MassUpdate::Keep));
    EXPECT_EQ(compound->Mass().centerOfMass, before.centerOfMass);
    EXPECT_EQ(compound->Mass().principalInertia, before.principalInertia);
    ASSERT_TRUE(compound->UpdateMass());
    ExpectSameMass(*compound, *Compound::Create(compound->Settings()).Value());
}

TEST(MutableCompound, ACopyIsEditedByItself) {
    RandomChildren random(5);
    const auto compound = MutableCompound::Create(random.Next(10)).Value();
    ASSERT_TRUE(compound->Remove({4, 0}));
    const auto copy = compound->Copy();
    EXPECT_FALSE(copy->Exists({4, 0}));
    const ChildSettings child = random.Next();
    EXPECT_EQ(copy->Add(child).Value(), (ChildId{4, 1}));
    EXPECT_EQ(compound->Count(), 9u);
    EXPECT_EQ(copy->Count(), 10u);
}

TEST(MutableCompound, BadEditsAreRefusedAndChangeNothing) {
    RandomChildren random(6);
    const auto compound = MutableCompound::Create(random.Next(2)).Value();
    const MassProperties before = compound->Mass();
    const ShapePtr box = Box::Create(Vector3(1, 1, 1)).Value(), nested = compound;
    const auto code = [](const auto& result) { return result ? ErrorCode(-1) : result.GetError().code; };
    EXPECT_EQ(code(MutableCompound::Create({})), ErrorCode::Degenerate);
    EXPECT_EQ(code(compound->Add({.shape = nullptr})), ErrorCode::Unsupported);
    EXPECT_NE(compound->Add({.shape = nested}).GetError().message.find("child is a mutable compound"),
              std::string::npos);
    EXPECT_EQ(code(compound->Add({.shape = box, .position = {NAN, 0, 0}})), ErrorCode::NonFinite);
    EXPECT_EQ(code(compound->Add({.shape = box, .position = {1e20f, 0, 0}})), ErrorCode::OutOfRange);
    EXPECT_EQ(code(compound->Add({.shape = box, .position = {1e20f, 0, 0}}, MassUpdate::Keep)), ErrorCode::OutOfRange);
    // A reduced mass of 5e5 m3 times the square of 9e17 m is no float.
    const ShapePtr large = Box::Create(Vector3(50, 50, 50)).Value();
    const ChildSettings here[] = {{.shape = large}};
    EXPECT_EQ(code(MutableCompound::Create(here).Value()->Add({.shape = large, .position = {9e17f, 0, 0}})),
              ErrorCode::OutOfRange);
    EXPECT_EQ(code(compound->Add({.shape = box, .rotation = {0, 0, 0, 2}})), ErrorCode::Unnormalized);
    EXPECT_EQ(code(compound->Add({.shape = box, .density = 0})), ErrorCode::NonPositive);
    EXPECT_EQ(code(compound->Move({0, 1}, {0, 0, 0}, {})), ErrorCode::UnknownId);
    EXPECT_EQ(code(compound->Move({2, 0}, {0, 0, 0}, {})), ErrorCode::UnknownId);
    EXPECT_EQ(code(compound->Move({0, 0}, {0, 0, 0}, {0, 0, 0, NAN})), ErrorCode::NonFinite);
    EXPECT_EQ(compound->Mass().centerOfMass, before.centerOfMass);
    EXPECT_EQ(compound->Count(), 2u);
    ASSERT_TRUE(compound->Remove({0, 0}));
    EXPECT_EQ(code(compound->Remove({0, 0})), ErrorCode::UnknownId);
    EXPECT_EQ(code(compound->Remove({1, 0})), ErrorCode::Degenerate);
}

TEST(MutableCompound, IsScaledChildByChild) {
    RandomChildren random(7);
    const std::vector<ChildSettings> children = random.Next(5);
    const ShapePtr compound = MutableCompound::Create(children).Value(), still = Compound::Create(children).Value();
    const ShapePtr twice = Scaled(compound, Vector3(2, 2, 2)).Value();
    EXPECT_EQ(twice->Type(), ShapeType::MutableCompound);
    ExpectSameMass(*twice, *Scaled(still, Vector3(2, 2, 2)).Value());
}

// An edit may only update the sums up to the total: of eight at each of five levels.
TEST(MutableCompound, AnEditOfOneOfManyAllocatesNothing) {
    RandomChildren random(8);
    const auto compound = MutableCompound::Create(random.Next(10000)).Value();
    ASSERT_TRUE(compound->Move({5000, 0}, {1, 2, 3}, {}));
    const uint64_t before = AllocationCount();
    for (int i = 0; i < 100; ++i) {
        const Status moved = compound->Move({5000, 0}, {1, 2, static_cast<float>(i) * 0.01f}, {});
        if (!moved) ADD_FAILURE();
    }
    EXPECT_EQ(AllocationCount() - before, 0u);
}

}  // namespace
}  // namespace fulcrum::testing
