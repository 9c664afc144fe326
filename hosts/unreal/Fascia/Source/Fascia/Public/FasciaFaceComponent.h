// A face of a Fascia rig as a procedural mesh: loads a .glb, steps it each frame, writes its sections.
#pragma once

#include "CoreMinimal.h"
#include "ProceduralMeshComponent.h"

#include "FasciaFaceComponent.generated.h"

struct fascia_asset;
struct fascia_face;

UCLASS(ClassGroup = (Animation), meta = (BlueprintSpawnableComponent))
class UFasciaFaceComponent : public UProceduralMeshComponent {
  GENERATED_BODY()

 public:
  UFasciaFaceComponent(const FObjectInitializer& Initializer);

  /** A rig that `fascia build` has made, relative to the project's content. */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = Fascia)
  FFilePath Rig;

  /** Level of detail, 0 the coarsest; -1 the finest. */
  UPROPERTY(EditAnywhere, BlueprintReadOnly, Category = Fascia)
  int32 Level = -1;

  /** How much the head's motion shakes loose tissue: 1 is physical. */
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = Fascia)
  float Inertia = 1.0f;

  /** Loads `Rig`; false, with a message in the log, when that cannot be. */
  UFUNCTION(BlueprintCallable, Category = Fascia)
  bool LoadRig();

  /** Sets a channel or a member such as "arkit:jawOpen"; false when the rig has no such name. */
  UFUNCTION(BlueprintCallable, Category = Fascia)
  bool SetValue(const FString& Name, float Value);

  /** ARKit weights by name, as Live Link gives them. */
  UFUNCTION(BlueprintCallable, Category = Fascia)
  void SetWeights(const TMap<FName, float>& Weights);

  UFUNCTION(BlueprintCallable, Category = Fascia)
  void ResetFace();

  virtual void BeginPlay() override;
  virtual void EndPlay(const EEndPlayReason::Type Reason) override;
  virtual void TickComponent(float Seconds, ELevelTick Kind, FActorComponentTickFunction* Function) override;

 private:
  void Release();
  void WriteSections(bool bCreates);

  fascia_asset* Asset = nullptr;
  fascia_face* Face = nullptr;
  TArray<FVector> Positions, Normals;
};
