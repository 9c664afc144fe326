#pragma once
#include "CoreMinimal.h"
struct UProceduralMeshComponent {
  explicit UProceduralMeshComponent(const FObjectInitializer&) {}
  virtual ~UProceduralMeshComponent() = default;
  virtual void BeginPlay() {}
  virtual void EndPlay(const EEndPlayReason::Type) {}
  virtual void TickComponent(float, ELevelTick, FActorComponentTickFunction*) {}
  void ClearAllMeshSections() {}
  FTransform GetComponentTransform() const { return {}; }
  void CreateMeshSection(int32, const TArray<FVector>&, const TArray<int32>&, const TArray<FVector>&,
                         const TArray<FVector2D>&, const TArray<FColor>&, const TArray<FProcMeshTangent>&,
                         bool) {}
  void UpdateMeshSection(int32, const TArray<FVector>&, const TArray<FVector>&, const TArray<FVector2D>&,
                         const TArray<FColor>&, const TArray<FProcMeshTangent>&) {}
  FActorComponentTickFunction PrimaryComponentTick;
};
