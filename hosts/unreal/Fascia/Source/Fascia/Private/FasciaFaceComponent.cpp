#include "FasciaFaceComponent.h"

#include "HAL/UnrealMemory.h"
#include "Misc/FileHelper.h"
#include "Misc/Paths.h"
#include "Modules/ModuleManager.h"

#include "fascia/fascia.h"

IMPLEMENT_MODULE(FDefaultModuleImpl, Fascia)

DEFINE_LOG_CATEGORY_STATIC(LogFascia, Log, All);

namespace {

constexpr double CentimetresPerMetre = 100.0;

/** The rig's metres, +Y up, facing +Z, to the engine's centimetres, +Z up, facing +X; right-handed to
 * left-handed. */
FVector ToEngine(const float* Vector, double Scale) {
  return FVector(Vector[2], Vector[0], Vector[1]) * Scale;
}

bool Check(fascia_result Result, const TCHAR* What) {
  if (Result == FASCIA_OK || Result == FASCIA_ERROR_DIVERGED) return true;
  UE_LOG(LogFascia, Error, TEXT("%s: %s"), What, UTF8_TO_TCHAR(fascia_last_message()));
  return false;
}

}  // namespace

UFasciaFaceComponent::UFasciaFaceComponent(const FObjectInitializer& Initializer) : Super(Initializer) {
  PrimaryComponentTick.bCanEverTick = true;
}

void UFasciaFaceComponent::BeginPlay() {
  Super::BeginPlay();
  if (!Rig.FilePath.IsEmpty()) LoadRig();
}

void UFasciaFaceComponent::EndPlay(const EEndPlayReason::Type Reason) {
  Release();
  Super::EndPlay(Reason);
}

void UFasciaFaceComponent::Release() {
  fascia_face_release(Face);
  fascia_asset_release(Asset);
  Face = nullptr;
  Asset = nullptr;
}

bool UFasciaFaceComponent::LoadRig() {
  Release();
  ClearAllMeshSections();
  TArray<uint8> Bytes;
  const FString Path = FPaths::ConvertRelativePathToFull(FPaths::ProjectContentDir(), Rig.FilePath);
  if (!FFileHelper::LoadFileToArray(Bytes, *Path)) {
    UE_LOG(LogFascia, Error, TEXT("%s cannot be read"), *Path);
    return false;
  }
  fascia_face_options Options = fascia_default_face_options();
  Options.space = FASCIA_SPACE_METRES;
  Options.level = Level;
  if (!Check(fascia_asset_load(Bytes.GetData(), Bytes.Num(), &Asset), *Path) ||
      !Check(fascia_face_create(Asset, &Options, &Face), *Path)) {
    Release();
    return false;
  }
  WriteSections(true);
  return true;
}

bool UFasciaFaceComponent::SetValue(const FString& Name, float Value) {
  return Face != nullptr && fascia_face_set(Face, TCHAR_TO_UTF8(*Name), Value) == FASCIA_OK;
}

void UFasciaFaceComponent::SetWeights(const TMap<FName, float>& Weights) {
  for (const auto& [Name, Value] : Weights)
    SetValue(Name.ToString(), Value);
}

void UFasciaFaceComponent::ResetFace() {
  if (Face == nullptr) return;
  fascia_face_clear(Face);
  fascia_face_reset(Face);
}

void UFasciaFaceComponent::TickComponent(float Seconds, ELevelTick Kind,
                                         FActorComponentTickFunction* Function) {
  Super::TickComponent(Seconds, Kind, Function);
  if (Face == nullptr) return;
  // The head's place, back in the rig's metres and axes, column by column.
  const FTransform World = GetComponentTransform();
  float Place[16] = {};
  const FVector Axes[3] = {World.GetUnitAxis(EAxis::Y), World.GetUnitAxis(EAxis::Z),
                           World.GetUnitAxis(EAxis::X)};
  const auto Put = [&Place](int32 Column, const FVector& V) {
    Place[4 * Column] = static_cast<float>(V.Y);
    Place[4 * Column + 1] = static_cast<float>(V.Z);
    Place[4 * Column + 2] = static_cast<float>(V.X);
  };
  for (int32 Column = 0; Column < 3; ++Column)
    Put(Column, Axes[Column]);
  Put(3, World.GetLocation() / CentimetresPerMetre);
  Place[15] = 1.0f;
  fascia_face_move_head(Face, Place, Inertia);
  if (Check(fascia_face_step(Face, FMath::Clamp(Seconds, 0.0f, 1.0f)), TEXT("step"))) WriteSections(false);
}

void UFasciaFaceComponent::WriteSections(bool bCreates) {
  fascia_asset_info Info = {sizeof Info};
  fascia_asset_get_info(Asset, &Info);
  for (uint32 Mesh = 0; Mesh < Info.mesh_count; ++Mesh) {
    fascia_vectors Places = {sizeof Places}, Directions = {sizeof Directions};
    if (fascia_face_positions(Face, Mesh, &Places) != FASCIA_OK ||
        fascia_face_normals(Face, Mesh, &Directions) != FASCIA_OK)
      continue;
    Positions.SetNumUninitialized(Places.count, false);
    Normals.SetNumUninitialized(Places.count, false);
    for (uint32 V = 0; V < Places.count; ++V) {
      Positions[V] = ToEngine(Places.data + 3 * V, CentimetresPerMetre);
      Normals[V] = ToEngine(Directions.data + 3 * V, 1.0);
    }
    if (!bCreates) {
      UpdateMeshSection(Mesh, Positions, Normals, {}, {}, {});
      continue;
    }
    fascia_mesh_info Shape = {sizeof Shape};
    fascia_asset_get_mesh(Asset, Mesh, &Shape);
    TArray<int32> Triangles;
    for (uint32 T = 0; T < Shape.triangle_count;
         ++T)  // the axes' handedness turns round, and the triangles with it
      Triangles.Append({static_cast<int32>(Shape.triangles[3 * T]),
                        static_cast<int32>(Shape.triangles[3 * T + 2]),
                        static_cast<int32>(Shape.triangles[3 * T + 1])});
    fascia_vectors Texture = {sizeof Texture};  // none if the file has none; the origin is the engine's
    fascia_asset_texcoords(Asset, Mesh, &Texture);
    TArray<FVector2D> TexCoords;
    TexCoords.SetNumUninitialized(Texture.count, false);
    for (uint32 V = 0; V < Texture.count; ++V)
      TexCoords[V] = FVector2D(Texture.data[2 * V], Texture.data[2 * V + 1]);
    CreateMeshSection(Mesh, Positions, Triangles, Normals, TexCoords, {}, {}, false);
  }
}
