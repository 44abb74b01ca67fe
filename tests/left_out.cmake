# Tests that are left out under the sanitizers, as GoogleTest's patterns: shipped datasets, killed processes, comparisons of
# bytes and the longest of each kind, minutes on paths that other tests take too.
set(SLIPMODE_LEFT_OUT
  *Dataset* *SameBytes* *Ranks* *TheBytesOfOneProcess* *Killed* *AfterAKill* *WithoutAFileGoOn* *AnInterruptedContinuation*
  *GivesTheSameForAnyNumberOfThreads* *SameRunForAnyThreads* *GivesTheSameNumbersInText* Manual*
  *CertifiedSteps.*1em1* *CertifiedSteps.*1em3* *CertifiedSteps.*1em6* *CertifiedSteps.*Contacts2* *MissNoEventAndKeep*
  *DifferencedMap* *ForcedTangent.EqualsCentral* *TakesTheVelocityFarthest* *OfTenSeedsThatOnceFailed* *AThousandScenes*
  *Extremes.HoldTheirLaws* *StopsOnSeveralMassesAreLeft*
  *JointOrbits* *OrderIsChosen* *OfABeamWithRigid* *WaysToThePeriodic* *RandomChainsConverge* *ToTheHopfPoint*
  *SpecialCurve.Folds* *SpecialCurve.Grazing* *SpecialCurve.LossOf* *SpecialCurve.AFoldBeside* *BalanceCurve.Folds*
  *BalanceCurve.Tends* *BalanceCurve.Period* *BalanceCurve.Neimark* *FollowedOverASecondKey* *MixedWithItsTrueError*
  *OrbitMethods.ErrorsAre* *PastASecondTurn*
  *Divergence* *Lorenz* *Roessler* *TellsChaosFromNoise* *ChaosIsLost* *DoesNotTakeALimitCycle*
  *IsFalseInAtMost* *AsksForStatistics* *OfManyMasses* *OfOwnMatricesIsCompared* *GrowsUntilTheDeviation*)
list(JOIN SLIPMODE_LEFT_OUT ":" SLIPMODE_LEFT_OUT)
